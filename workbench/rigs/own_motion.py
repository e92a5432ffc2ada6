"""Motion of any machine under its drive torques: links, rotors behind springs and gaps, dry friction.

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
_STILL = 1e-9  # rad/s or m/s
_PARTS = 8


@dataclass
class OwnState:
    """State of a machine: links in drive coordinates, and rotors where springs are.

    `q`, `v`: (n,) of the links; `motor`, `speed`: (n,) of the rotors, the same where nothing lies between.
    """

    q: np.ndarray
    v: np.ndarray
    motor: np.ndarray
    speed: np.ndarray


class OwnMotion:
    """Integrator of a machine.

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
        """Return the state at rest at drive positions `q` (n,), every gap in its middle."""
        return OwnState(q.copy(), np.zeros(self._n), q.copy(), np.zeros(self._n))

    def rest(self, state: OwnState) -> OwnState:
        """Return a state at rest where this one is."""
        self._acceleration = np.zeros(self._wide)
        return OwnState(state.q, np.zeros(self._n), state.motor, np.zeros(self._n))

    def advance(self, state: OwnState, torque: np.ndarray) -> OwnState:
        """Return the state after one piece, with torques (n,) on the rotors [N m].

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
        pins = _Pins(self._machine.frictions, self._rows_of_pins(slope), torque, motor, joints)
        new, mean = _step(mass, drag, force, v, h, pins, 1)
        if pins.turned(v, new):
            # where a pin stops or turns round, when it does so matters: the same forces in shorter parts
            new, mean = _step(mass, drag, force, v, h, pins, _PARTS)
        self._acceleration = (new - v) / h
        return OwnState(state.q + h * mean[:n], new[:n], state.motor + h * mean[self._row], new[self._row])

    def _rows_of_pins(self, slope: np.ndarray) -> np.ndarray:
        """Slip of each dry friction as a row over the wide velocities (pins, wide)."""
        rows = [self._direction(f.direction, f.at_pin, slope) for f in self._machine.frictions]
        return np.array(rows).reshape(-1, self._wide)

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


@dataclass
class _Pins:
    """Dry frictions of one step: rows of their slips (pins, wide), and what their levels depend on."""

    frictions: list[Friction]
    rows: np.ndarray
    torque: np.ndarray
    motor: np.ndarray
    joints: np.ndarray

    def turned(self, before: np.ndarray, after: np.ndarray) -> bool:
        """Whether a pin that slid stopped or turned round, or one that stuck began to slide."""
        old, new = self.rows @ before, self.rows @ after
        moved = (np.abs(old) > _STILL) | (np.abs(new) > _STILL)
        return bool(np.any(moved & (np.sign(old) != np.sign(new))))

    def rub(self, new: np.ndarray, old: np.ndarray, implicit: np.ndarray, h: float) -> np.ndarray:
        """Velocities (wide,) with the impulses of all pins over `h` [s] in them."""
        give = np.linalg.solve(implicit, self.rows.T)  # velocities of a unit impulse at each pin
        along, slip, before = self.rows @ give, self.rows @ new, self.rows @ old
        # the level is that of the motion before, or of the way in which the pin would start
        way = np.where(np.abs(before) > _STILL, before, np.copysign(1e-12, slip))
        most = h * np.array([self._level(f, float(w)) for f, w in zip(self.frictions, way, strict=True)])
        impulse = np.zeros(len(most))
        for _ in range(_SWEEPS):
            last = impulse.copy()
            for i in range(len(impulse)):
                rest = slip[i] + along[i] @ impulse - along[i, i] * impulse[i]
                impulse[i] = np.clip(-rest / along[i, i], -most[i], most[i])
            if np.abs(impulse - last).max() < _ENOUGH:
                break
        return new + give @ impulse

    def _level(self, friction: Friction, way: float) -> float:
        place = float(np.array(friction.direction) @ (self.joints if friction.at_pin else self.motor))
        load = 0.0 if friction.load_axis is None else abs(float(self.torque[friction.load_axis]))
        return max(0.0, friction.level(way, place, load))


def _step(
    mass: np.ndarray, drag: np.ndarray, force: np.ndarray, v: np.ndarray, h: float, pins: _Pins, parts: int
) -> tuple[np.ndarray, np.ndarray]:
    """Velocities (wide,) after `h` [s], and their mean on the way, in so many parts."""
    part = h / parts
    implicit = mass + 0.5 * part * np.diag(drag)
    mean = np.zeros_like(v)
    for _ in range(parts):
        new = v + part * np.linalg.solve(implicit, force - drag * v)
        if pins.frictions:
            new = pins.rub(new, v, implicit, part)
        mean += 0.5 * (v + new) / parts
        v = new
    return v, mean


def refuse_runaway(state: OwnState, time: float, name: str) -> None:
    """Raise a SimulationError if the machine is faster than any real one."""
    if not np.abs(state.speed).max() < 1e3:
        raise SimulationError(f"{name} ran away at {time:.3f} s")
