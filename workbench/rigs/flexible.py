"""Equation of motion of the leg whose motors, links and stand move by themselves: two to six coordinates.

Angles are absolute, from straight down, and the stand's x points the way that a leg at a positive angle does.
In order: thigh q1, shank q2, and where it moves on its own: motor 1, motor 2, crank, stand x. With c the
crank, which carries the coupler (both come from Drake by `linkage_share`), kinetic and potential energy are

    T = J1 m1'^2/2 + J2 m2'^2/2 + M11 q1'^2/2 + Mcc c'^2/2 + M22 q2'^2/2 + Mx x'^2/2
        + (M1c cos(c - q1) c' + M12 cos(q2 - q1) q2') q1' + (s1 cos q1 q1' + sc cos c c' + s2 cos q2 q2') x'
    V = -g1 cos q1 - gc cos c - g2 cos q2 + springs,        s = g / 9.81: a first moment of mass [kg m]

and the equations are Lagrange's. A coordinate that does not move on its own is its neighbour: motor 1 the
thigh; motor 2 the crank, the crank the shank. Solving for accelerations is cheap because only thigh and stand
couple with more than one other: crank and shank are eliminated first.
"""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, cos, sin

import numpy as np

from workbench.mechanism.parse import GRAVITY

from .along import Vector
from .events import TIGHT
from .leg_file import leg_mass
from .machine import Machine
from .place import Place
from .structure import LegStructure, linkage_share

THIGH, SHANK = 0, 1
HIP_DRIVE = Place(0, (1.0, 0.0))
KNEE_DRIVE = Place(1, (0.0, 1.0))
KNEE_PIN = Place(1, (-1.0, 1.0), at_pin=True)


class FlexibleLeg:
    """Links, rotors, couplings and stand of a machine, without motor torques and friction.

    Attributes:
        size: number of coordinates.
        motors: coordinates of the two motors.
        forces: torque on every coordinate (n,) [N m, N] of position (n,), speed (n,) and outside torque (n,);
            all but inertia: gravity, velocity terms, drives' damping, couplings, of flanks those that touched
            when `meet` was called.
        give: acceleration (n,) of position (n,) and torque (n,): the inverse mass matrix.
    """

    def __init__(self, machine: Machine) -> None:
        hip, drive, pin = (machine.couplings.get(at) for at in (HIP_DRIVE, KNEE_DRIVE, KNEE_PIN))
        self.size = 2
        motor1 = self._own(hip) or THIGH
        motor2 = self._own(drive)
        crank = self._own(pin) or SHANK
        motor2 = motor2 or crank
        stand = self._own(machine.base)
        self.motors, self._crank, self._stand = (motor1, motor2), crank, stand
        self._machine = machine
        self._couplings = [
            (front, back, coupling)
            for front, back, coupling in ((motor1, THIGH, hip), (motor2, crank, drive), (crank, SHANK, pin))
            if coupling is not None
        ]
        total = machine.links
        linkage = (
            LegStructure(0.0, 0.0, 0.0, 0.0, 0.0)
            if crank == SHANK
            else linkage_share((machine.longer[0], machine.longer[1]))
        )
        self._linkage, self._rest = linkage, total.minus(linkage)
        self._mass = leg_mass() + machine.payload
        diagonal = [0.0] * self.size
        for index, inertia in (
            (THIGH, self._rest.m11),
            (SHANK, self._rest.m22),
            (crank, linkage.m22),
            (motor1, machine.rotor[0]),
            (motor2, machine.rotor[1]),
        ):
            diagonal[index] += inertia
        if machine.base is not None and stand is not None:
            diagonal[stand] = machine.base.mass + self._mass
        self._diagonal = diagonal
        self._shifts = [0.0] * len(self._couplings)
        self._touching = [not c.gap for _, _, c in self._couplings]
        self.forces, self.give = self._make_forces(), self._make_give()

    def _own(self, part: object) -> int | None:
        """A coordinate of its own where a part moves on its own."""
        if part is None:
            return None
        self.size += 1
        return self.size - 1

    def start(self, q1: float, q2: float) -> Vector:
        """Return coordinates (n,) with motors at `q1`, `q2` [rad] and everything else relaxed."""
        q = [0.0] * self.size
        motor1, motor2 = self.motors
        for index, angle in ((THIGH, q1), (motor1, q1), (SHANK, q2), (self._crank, q2), (motor2, q2)):
            q[index] = angle
        return q

    def direction(self, at: Place) -> tuple[float, ...]:
        """Return the direction of a place (n,): of its motor for a drive, of the links for a pin."""
        vector = [0.0] * self.size
        first, second = (THIGH, SHANK) if at.at_pin else self.motors
        vector[first] += at.direction[0]
        vector[second] += at.direction[1]
        return tuple(vector)

    def meet(self, q: Vector, v: Vector) -> None:
        """Set which flanks touch until the next call: those that are bent, and those just reached."""
        for k, (front, back, coupling) in enumerate(self._couplings):
            if coupling.gap:
                wind, rate, half = q[front] - q[back], v[front] - v[back], 0.5 * coupling.gap
                into = abs(wind) - half
                self._touching[k] = into > (-TIGHT if rate * wind > 0.0 else TIGHT)
                self._shifts[k] = copysign(half, wind)

    def gaps(self) -> list[tuple[int, int, float]]:
        """Return gaps as the coordinates before and behind them, and half of the gap [rad]."""
        return [(front, back, 0.5 * c.gap) for front, back, c in self._couplings if c.gap]

    def energy(self, q: Vector, v: Vector) -> float:
        """Return kinetic and potential energy [J], including springs."""
        mass = np.linalg.inv(np.array([self.give(q, list(unit)) for unit in np.eye(self.size)]))
        kinetic = 0.5 * float(np.array(v) @ mass @ np.array(v))
        rest, linkage = self._rest, self._linkage
        height = rest.g1 * cos(q[THIGH]) + rest.g2 * cos(q[SHANK]) + linkage.g2 * cos(q[self._crank])
        springs = sum(
            0.5 * c.stiffness * _dead(q[front] - q[back], 0.5 * c.gap) ** 2
            for front, back, c in self._couplings
        )
        if self._stand is not None and self._machine.base is not None:
            springs += 0.5 * self._machine.base.stiffness * q[self._stand] ** 2
        return kinetic - height + springs

    def fastest(self, springs: list[tuple[tuple[float, ...], float]]) -> float:
        """Return the largest rate of any mode around a stretched leg, with every gap closed [1/s].

        Args:
            springs: further stiffnesses as direction (n,) and [N m/rad].
        """
        n, machine = self.size, self._machine
        q = [0.0] * n  # thigh and shank in line couple most
        inverse = np.array([self.give(q, list(unit)) for unit in np.eye(n)])
        stiffness, damping = np.zeros((n, n)), np.zeros((n, n))
        for front, back, c in self._couplings:
            across = np.eye(n)[front] - np.eye(n)[back]
            stiffness += c.stiffness * np.outer(across, across)
            damping += c.damping * np.outer(across, across)
        if machine.base is not None and self._stand is not None:
            stiffness[self._stand, self._stand] += machine.base.stiffness
            damping[self._stand, self._stand] += machine.base.damping
        for direction, amount in springs:
            stiffness += amount * np.outer(direction, direction)
        for motor, amount in zip(self.motors, machine.damping, strict=True):
            damping[motor, motor] += amount
        rates = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
        return float(np.abs(np.linalg.eigvals(rates)).max())

    def _make_forces(self) -> Callable[[Vector, Vector, Vector], Vector]:
        rest, linkage, crank, stand = self._rest, self._linkage, self._crank, self._stand
        m12, g1, g2, m1c, gc = rest.m12, rest.g1, rest.g2, linkage.m12, linkage.g2
        s1, s2, sc = g1 / GRAVITY, g2 / GRAVITY, gc / GRAVITY
        (motor1, motor2), (b1, b2), base = self.motors, self._machine.damping, self._machine.base
        couplings = [(k, f, b, c.stiffness, c.damping) for k, (f, b, c) in enumerate(self._couplings)]
        touching, shifts = self._touching, self._shifts

        def forces(q: Vector, v: Vector, outside: Vector) -> Vector:
            t = outside[:]
            q1, q2, v1, v2 = q[0], q[1], v[0], v[1]
            curl = m12 * sin(q2 - q1)
            t[0] += curl * v2 * v2 - g1 * sin(q1)
            t[1] -= curl * v1 * v1 + g2 * sin(q2)
            t[motor1] -= b1 * v[motor1]
            t[motor2] -= b2 * v[motor2]
            for k, front, back, stiffness, damping in couplings:
                if touching[k]:
                    torque = stiffness * (q[front] - q[back] - shifts[k]) + damping * (v[front] - v[back])
                    t[front] -= torque
                    t[back] += torque
            if crank != SHANK:
                qc, vc = q[crank], v[crank]
                curl = m1c * sin(qc - q1)
                t[0] += curl * vc * vc
                t[crank] -= curl * v1 * v1 + gc * sin(qc)
                if stand is not None:
                    t[stand] += sc * sin(qc) * vc * vc
            if stand is not None and base is not None:
                t[stand] += s1 * sin(q1) * v1 * v1 + s2 * sin(q2) * v2 * v2
                t[stand] -= base.stiffness * q[stand] + base.damping * v[stand]
            return t

        return forces

    def _make_give(self) -> Callable[[Vector, Vector], Vector]:
        """Block elimination: shank, then crank, out of thigh and stand."""
        rest, linkage, stand = self._rest, self._linkage, self._stand
        d, m12, m1c = self._diagonal, rest.m12, linkage.m12
        s1, s2, sc = rest.g1 / GRAVITY, rest.g2 / GRAVITY, linkage.g2 / GRAVITY
        d0, d1 = d[THIGH], d[SHANK]
        crank = None if self._crank == SHANK else self._crank
        free = [m for m in self.motors if m not in (THIGH, SHANK, crank)]

        def give(q: Vector, t: Vector) -> Vector:
            a = t[:]
            for motor in free:
                a[motor] = t[motor] / d[motor]
            q1, q2, t1 = q[0], q[1], t[1]
            c = m12 * cos(q2 - q1)
            left, right = d0 - c * c / d1, t[0] - c * t1 / d1
            k = 0.0
            if crank is not None:
                k = m1c * cos(q[crank] - q1)
                left -= k * k / d[crank]
                right -= k * t[crank] / d[crank]
            if stand is None:
                a[0] = a1 = right / left
                a[1] = (t1 - c * a1) / d1
                if crank is not None:
                    a[crank] = (t[crank] - k * a1) / d[crank]
                return a
            x1, x2 = s1 * cos(q1), s2 * cos(q2)
            cross, corner, pull = x1 - c * x2 / d1, d[stand] - x2 * x2 / d1, t[stand] - x2 * t1 / d1
            xc = 0.0
            if crank is not None:
                xc = sc * cos(q[crank])
                cross -= k * xc / d[crank]
                corner -= xc * xc / d[crank]
                pull -= xc * t[crank] / d[crank]
            det = left * corner - cross * cross
            a[0] = a1 = (corner * right - cross * pull) / det
            a[stand] = ax = (left * pull - cross * right) / det
            a[1] = (t1 - c * a1 - x2 * ax) / d1
            if crank is not None:
                a[crank] = (t[crank] - k * a1 - xc * ax) / d[crank]
            return a

        return give


def _dead(wind: float, half: float) -> float:
    """What is left of an angle beyond half a gap either way [rad]."""
    return wind - half if wind > half else wind + half if wind < -half else 0.0
