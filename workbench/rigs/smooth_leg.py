"""The leg without dry friction: its acceleration as plain float code, and one step of it."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin

from .place import Passive
from .structure import LegStructure

State = tuple[float, float, float, float]  # q1, q2 [rad], v1, v2 [rad/s]
#: Extra torque (2,) [N m] of a state q1, q2, v1, v2.
PassiveTorque = Callable[[float, float, float, float], tuple[float, float]]


def passive_torque(passive: Passive) -> PassiveTorque:
    """Return a smooth torque at one place in actuator coordinates."""
    (d1, d2), law = passive.at.direction, passive.law
    f1, f2 = passive.feels or passive.at.direction

    def torque(q1: float, q2: float, v1: float, v2: float) -> tuple[float, float]:
        amount = law(f1 * q1 + f2 * q2, f1 * v1 + f2 * v2)
        return d1 * amount, d2 * amount

    return torque


def smooth_acceleration(
    structure: LegStructure, damping: tuple[float, float], passive: tuple[PassiveTorque, ...]
) -> Callable[[float, float, float, float, float, float], tuple[float, float]]:
    """Return the acceleration without dry friction as a closure over floats: it runs a million times."""
    m11, m12, m22, g1, g2 = structure.m11, structure.m12, structure.m22, structure.g1, structure.g2
    b1, b2 = damping
    diagonal = m11 * m22

    def acceleration(q1: float, q2: float, v1: float, v2: float, u1: float, u2: float) -> tuple[float, float]:
        alpha = q2 - q1
        coupling = m12 * cos(alpha)
        curl = m12 * sin(alpha)
        t1 = u1 - b1 * v1 - g1 * sin(q1) + curl * v2 * v2
        t2 = u2 - b2 * v2 - g2 * sin(q2) - curl * v1 * v1
        for torque in passive:
            p1, p2 = torque(q1, q2, v1, v2)
            t1 += p1
            t2 += p2
        det = diagonal - coupling * coupling
        return (m22 * t1 - coupling * t2) / det, (m11 * t2 - coupling * t1) / det

    return acceleration


def rk4(rate: Callable, state: State, u1: float, u2: float, h: float) -> State:
    """Return the state after one classical Runge-Kutta step of length `h` [s]."""
    q1, q2, v1, v2 = state
    half = 0.5 * h
    a1, a2 = rate(q1, q2, v1, v2, u1, u2)
    w1, w2 = v1 + half * a1, v2 + half * a2
    b1, b2 = rate(q1 + half * v1, q2 + half * v2, w1, w2, u1, u2)
    x1, x2 = v1 + half * b1, v2 + half * b2
    c1, c2 = rate(q1 + half * w1, q2 + half * w2, x1, x2, u1, u2)
    y1, y2 = v1 + h * c1, v2 + h * c2
    d1, d2 = rate(q1 + h * x1, q2 + h * x2, y1, y2, u1, u2)
    sixth = h / 6.0
    return (
        q1 + sixth * (v1 + 2.0 * (w1 + x1) + y1),
        q2 + sixth * (v2 + 2.0 * (w2 + x2) + y2),
        v1 + sixth * (a1 + 2.0 * (b1 + c1) + d1),
        v2 + sixth * (a2 + 2.0 * (b2 + c2) + d2),
    )
