"""How any machine moves under the torques of its drives: links, rotors behind springs and gaps, dry friction.

Time goes in short pieces. Mass and forces are taken in the middle of each (second order), the drives' damping
is implicit, and dry friction acts as impulses that stop a pin or leave it sticking: each no larger than its
level allows, all of them at once, found by sweeps over the pins (projected Gauss-Seidel).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import SimulationError

from .coupling import Coupling
from .friction import Friction
from .own_links import OwnLinks
from .own_machine import OwnMachine

_SWEEPS = 30
_ENOUGH = 1e-12  # N m s, change of an impulse that is none


@dataclass
class OwnState:
    """Where a machine is: links in drive coordinates, and the rotors, which lead them where springs are.

    `q`, `v`: (n,) of the links; `motor`, `speed`: (n,) of the rotors, the same where nothing lies between.
    """

    q: np.ndarray
    v: np.ndarray
    motor: np.ndarray
    speed: np.ndarray


class OwnMotion:
    """Moves a machine on from state to state.

    Args:
        machine: with all that is hidden in it.
        links: its links.
        piece: length of a step [s].
    """

    def __init__(self, machine: OwnMachine, links: OwnLinks, piece: float) -> None:
        self._machine, self._links, self._h = machine, links, piece
        self._couplings: dict[int, Coupling] = {at.index: c for at, c in machine.couplings.items()}
        n = machine.size
        self._soft = sorted(self._couplings)
        self._rotor, self._damping = np.array(machine.rotor), np.array(machine.damping)
        self._n, self._wide = n, n + len(self._soft)
        # row of each rotor in the wide vector: links first, then rotors that are apart from them
        self._row = [n + self._soft.index(k) if k in self._soft else k for k in range(n)]
        self._needs_joints = any(f.at_pin for f in machine.frictions) or any(
            p.at.at_pin for p in machine.passive
        )
        self._acceleration = np.zeros(self._wide)

    def start(self, q: np.ndarray) -> OwnState:
        """At rest at drive positions `q` (n,), every gap in its middle."""
        return OwnState(q.copy(), np.zeros(self._n), q.copy(), np.zeros(self._n))

    def advance(self, state: OwnState, torque: np.ndarray) -> OwnState:
        """One piece on, with torques (n,) on the rotors [N m].

        Raises:
            SimulationError: the mechanism leaves its workspace.
        """
        h, n = self._h, self._n
        v = np.concatenate([state.v, state.speed[self._soft]])
        middle = v + 0.5 * h * self._acceleration
        q = state.q + 0.5 * h * middle[:n]
        motor = state.motor + 0.5 * h * middle[self._row]
        mass, force = self._wide_links(q, middle[:n])
        self._add_drives(mass, force, torque)
        self._add_springs(force, q, motor, middle)
        joints, slope = self._links.joints(q) if self._needs_joints else (q, np.eye(n))
        for passive in self._machine.passive:
            row = self._direction(passive.at.direction, passive.at.at_pin, slope)
            own = np.array(passive.at.direction)
            place = own @ (joints if passive.at.at_pin else motor)
            force += row * passive.law(float(place), float(row @ middle))
        drag = np.zeros(self._wide)
        drag[self._row] = self._damping
        implicit = mass + 0.5 * h * np.diag(drag)
        new = v + h * np.linalg.solve(implicit, force - drag * v)
        if self._machine.frictions:
            new = self._rub(new, v, implicit, (motor, joints, slope), torque)
        self._acceleration = (new - v) / h
        mean = 0.5 * (v + new)
        return OwnState(state.q + h * mean[:n], new[:n], state.motor + h * mean[self._row], new[self._row])

    def _wide_links(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        mass, force = np.zeros((self._wide, self._wide)), np.zeros(self._wide)
        mass[: self._n, : self._n], force[: self._n] = self._links.at(q, v)
        return mass, force

    def _add_drives(self, mass: np.ndarray, force: np.ndarray, torque: np.ndarray) -> None:
        mass[self._row, self._row] += self._rotor
        force[self._row] += torque

    def _add_springs(self, force: np.ndarray, q: np.ndarray, motor: np.ndarray, rates: np.ndarray) -> None:
        for k, spring in self._couplings.items():
            wind, rate = motor[k] - q[k], rates[self._row[k]] - rates[k]
            beyond = wind - np.clip(wind, -0.5 * spring.gap, 0.5 * spring.gap)
            touching = spring.gap == 0.0 or beyond != 0.0
            push = spring.stiffness * beyond + (spring.damping * rate if touching else 0.0)
            if spring.gap and push * beyond < 0.0:
                push = 0.0  # a flank does not pull
            force[k] += push
            force[self._row[k]] -= push

    def _direction(self, own: tuple[float, ...], at_pin: bool, slope: np.ndarray) -> np.ndarray:
        """Speed at a place as a row over the wide velocities: of a serial joint, or of a rotor."""
        row = np.zeros(self._wide)
        if at_pin:
            row[: self._n] = np.array(own) @ slope
        else:
            row[self._row] = own
        return row

    def _rub(
        self, new: np.ndarray, old: np.ndarray, implicit: np.ndarray,
        where: tuple[np.ndarray, np.ndarray, np.ndarray], torque: np.ndarray,
    ) -> np.ndarray:  # fmt: skip
        motor, joints, slope = where
        frictions = self._machine.frictions
        rows = np.array([self._direction(f.direction, f.at_pin, slope) for f in frictions])
        give = np.linalg.solve(implicit, rows.T)  # velocities of a unit impulse at each pin (wide, pins)
        along = rows @ give
        slip, before = rows @ new, rows @ old
        # the level is that of the motion before, or of the way in which the pin would start
        way = np.where(np.abs(before) > 1e-9, before, np.copysign(1e-12, slip))
        most = self._h * np.array(
            [self._level(f, w, motor, joints, torque) for f, w in zip(frictions, way, strict=True)]
        )
        impulse = np.zeros(len(frictions))
        for _ in range(_SWEEPS):
            last = impulse.copy()
            for i in range(len(impulse)):
                rest = slip[i] + along[i] @ impulse - along[i, i] * impulse[i]
                impulse[i] = np.clip(-rest / along[i, i], -most[i], most[i])
            if np.abs(impulse - last).max() < _ENOUGH:
                break
        return new + give @ impulse

    def _level(
        self, friction: Friction, way: float, motor: np.ndarray, joints: np.ndarray, torque: np.ndarray
    ) -> float:
        place = float(np.array(friction.direction) @ (joints if friction.at_pin else motor))
        load = 0.0 if friction.load_axis is None else abs(float(torque[friction.load_axis]))
        return max(0.0, friction.level(float(way), place, load))


def refuse_runaway(state: OwnState, time: float, name: str) -> None:
    """Raises SimulationError where the machine is faster than any is."""
    if not np.abs(state.speed).max() < 1e3:
        raise SimulationError(f"{name} ran away at {time:.3f} s")
