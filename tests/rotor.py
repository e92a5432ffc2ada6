"""A rotor with a drive that has limits, in a PD loop: an own simulation of a few lines."""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, cos, pi
from pathlib import Path

import numpy as np

from workbench.core import Controller, Recording

ROTOR = """<mujoco><worldbody><body><joint name="m" axis="0 -1 0" armature="0.004" damping="0.01"/>
<inertial pos="0.05 0 0" mass="0.4" diaginertia="0.0002 0.0006 0.0006"/></body></worldbody></mujoco>"""
_STEP = 0.002


def pushed(
    folder: Path, reference: np.ndarray, gains: tuple[float, float], *, limit: float = 1e9,
    stall: float = 1e9, fastest: float = 1e9, gain: float = 1.0, bias: float = 0.0,
    friction: Callable[[float], float] = lambda w: 0.0, noise: float = 0.01, counts: int = 0,
    wobble: float = 0.0, late: int = 0, damped: float = 1.0, seed: int = 0, name: str = "r",
) -> Recording:  # fmt: skip
    """The rotor in `folder` / rotor.xml along a reference (N,) at 500 Hz.

    Limit and line clip the torque, of which the motor gives `gain`, and `bias` on top. `counts` a revolution
    and `wobble` [rad/s] are the sensors'. The torque acts `late` rows behind its command, of whose damping
    only the share `damped` is there. Steps of 0.1 ms are simple: the position is half of one ahead.
    """
    (folder / "rotor.xml").write_text(ROTOR)
    generator = np.random.default_rng(seed)
    kp, kd = gains
    q = w = 0.0
    rows, way = [], [0.0] * late
    for r in map(float, reference):
        at = 2 * pi / counts * round(q * counts / (2 * pi)) if counts else q
        speed = w + wobble * generator.standard_normal()
        asked = kp * (r - at) - damped * kd * speed
        ceiling = min(max(stall * (1.0 - copysign(1.0, asked) * w / fastest), 0.0), stall)
        way.append(asked)
        most = min(limit, ceiling)
        given = min(max(way.pop(0), -most), most)
        rows.append((at, speed, asked, given + noise * generator.standard_normal(), r))
        for _ in range(20):
            h = _STEP / 20
            w += h * (gain * given + bias - 0.01 * w - 0.4 * 9.81 * 0.05 * cos(q)) / 0.0056
            w = copysign(max(abs(w) - h * friction(w) / 0.0056, 0.0), w)
            q += h * w
    names = ("position", "velocity", "torque_command", "torque_measured", "position_reference")
    signals = {name: column[:, None] for name, column in zip(names, np.array(rows).T, strict=True)}
    loop = Controller("pd", "actuator", kp=(kp,), kd=(kd,), period_s=_STEP)
    time = np.arange(len(reference)) * _STEP
    return Recording(name, ("m",), "actuator", time, signals, ("rad",), controller=loop)


def wandering(seed: int, count: int = 2000) -> np.ndarray:
    """A reference that wanders through half a radian, faster and slower."""
    generator, t = np.random.default_rng(seed), np.arange(count) * _STEP
    f = generator.uniform(0.2, 6.0, 8)
    waves = 0.25 / f**0.8 * np.sin(2 * np.pi * np.outer(t, f) + generator.uniform(0, 6.28, 8))
    return waves.sum(axis=1) * np.minimum(t / 0.5, 1.0)


def torn(count: int = 3000) -> np.ndarray:
    """A reference that takes 50 times the torque of the drive, to and fro."""
    t = np.arange(count) * _STEP
    return np.sin(2.0 * np.pi * 3.0 * t) * np.minimum(t, 1.0)
