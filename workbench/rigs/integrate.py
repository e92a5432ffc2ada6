"""Integrates the leg through one stretch of constant motor torque, including stick and slip.

Two coordinates are too few for numpy to pay off, so this is plain float code: RK4 with the mode of every
dry friction (sticking, or sliding one way) fixed within a step. A slip speed that changes sign ends the step
at the crossing, where the friction either catches the pin or the pin turns round.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import copysign, cos

from .friction import Friction
from .smooth_leg import PassiveTorque, State, rk4, smooth_acceleration
from .structure import LegStructure

STEP = 0.25e-3  # largest integration step [s]
_MAX_EVENTS = 30  # in one step; more is chatter, which sticks


class Integrator:
    """The leg with actuators; it stores the stick-slip modes between calls, so use one per run.

    Args:
        structure: inertia and gravity of links, rotors included.
        damping: viscous damping of the two drives [N m s/rad].
        passive: further smooth torques.
        frictions: dry frictions, of at most two independent directions.
    """

    def __init__(
        self,
        structure: LegStructure,
        damping: tuple[float, float],
        passive: Sequence[PassiveTorque] = (),
        frictions: Sequence[Friction] = (),
    ) -> None:
        self._structure, self._damping = structure, damping
        self._passive, self._frictions = tuple(passive), tuple(frictions)
        self._modes: list[int] = []  # of each friction: 0 sticks, 1 and -1 slide; from the first state on
        self._slide = smooth_acceleration(structure, damping, self._passive)

    @staticmethod
    def start(q1: float, q2: float) -> State:
        """Return the state at rest at motor angles `q1`, `q2` [rad]."""
        return q1, q2, 0.0, 0.0

    @staticmethod
    def motors(state: State) -> tuple[float, float, float, float]:
        """Return angles [rad] and speeds [rad/s] of the motors: with rigid drives, the state itself."""
        return state

    def advance(self, state: State, u1: float, u2: float, duration: float) -> State:
        """Return the state after `duration` [s] under motor torques `u1`, `u2` [N m] (gain and bias in)."""
        steps = max(1, int(duration / STEP + 0.999999))
        h = duration / steps
        if not self._frictions:
            for _ in range(steps):
                state = rk4(self._slide, state, u1, u2, h)
            return state
        if not self._modes:
            slips = [d1 * state[2] + d2 * state[3] for d1, d2 in (f.direction for f in self._frictions)]
            self._modes = [(slip > 0.0) - (slip < 0.0) for slip in slips]
        for _ in range(steps):
            state = self._step_with_friction(state, u1, u2, h)
        return state

    def _step_with_friction(self, state: State, u1: float, u2: float, h: float) -> State:
        """One step, cut at every zero crossing of a slip speed."""
        load = (u1, u2)
        for _ in range(_MAX_EVENTS):
            self._release(state, u1, u2)
            rate = self._rate(load)
            after = rk4(rate, state, u1, u2, h)
            crossing = self._first_crossing(rate, state, after, u1, u2, h)
            if crossing is None:
                return self._pinned(after)
            index, part = crossing
            state = rk4(rate, state, u1, u2, part)
            self._modes[index] = 0
            state = self._pinned(state)
            h -= part
            if h <= 1e-12:
                return state
        return self._pinned(rk4(self._rate(load), state, u1, u2, h))

    def _release(self, state: State, u1: float, u2: float) -> None:
        """Lets go every stuck pin whose holding torque exceeds its static limit."""
        for _ in self._frictions:
            holding = self._holding(state, u1, u2)
            excess = []
            for index, torque in holding.items():
                friction = self._frictions[index]
                direction = copysign(1.0, -torque)
                limit = self._level(friction, direction * 0.0, state, (u1, u2))
                excess.append((abs(torque) - limit, index, int(direction)))
            worst = max(excess, default=(0.0, 0, 0))
            if worst[0] <= 0.0:
                return
            self._modes[worst[1]] = worst[2]

    def _holding(self, state: State, u1: float, u2: float) -> dict[int, float]:
        """Torque that each stuck pin needs to stay stuck [N m], by index."""
        stuck = [i for i, mode in enumerate(self._modes) if mode == 0]
        if not stuck:
            return {}
        torque1, torque2 = self._applied(state, u1, u2)
        m11, m12, m22, det = self._mass(state)
        a1, a2 = (m22 * torque1 - m12 * torque2) / det, (m11 * torque2 - m12 * torque1) / det
        directions = [self._frictions[i].direction for i in stuck]
        needed = [-(d[0] * a1 + d[1] * a2) for d in directions]

        def coupling(d: tuple[float, ...], e: tuple[float, ...]) -> float:
            return (d[0] * (m22 * e[0] - m12 * e[1]) + d[1] * (m11 * e[1] - m12 * e[0])) / det

        if len(stuck) == 1:
            return {stuck[0]: needed[0] / coupling(directions[0], directions[0])}
        (d, e), (n1, n2) = directions, needed
        w11, w12, w22 = coupling(d, d), coupling(d, e), coupling(e, e)
        area = w11 * w22 - w12 * w12
        return {stuck[0]: (w22 * n1 - w12 * n2) / area, stuck[1]: (w11 * n2 - w12 * n1) / area}

    def _applied(self, state: State, u1: float, u2: float) -> tuple[float, float]:
        """All torque except that of stuck pins and inertia, (2,) [N m]."""
        q1, q2, v1, v2 = state
        a1, a2 = self._slide(q1, q2, v1, v2, u1, u2)
        m11, m12, m22, _ = self._mass(state)
        t1, t2 = m11 * a1 + m12 * a2, m12 * a1 + m22 * a2
        for friction, mode in zip(self._frictions, self._modes, strict=True):
            if mode:
                d1, d2 = friction.direction
                slip = copysign(abs(d1 * v1 + d2 * v2), mode)
                torque = mode * self._level(friction, slip, state, (u1, u2))
                t1, t2 = t1 - d1 * torque, t2 - d2 * torque
        return t1, t2

    def _rate(self, load: tuple[float, float]) -> Callable[..., tuple[float, float]]:
        """Acceleration with the modes as they stand now."""
        slide, stuck = self._slide, 0 in self._modes

        def rate(q1: float, q2: float, v1: float, v2: float, u1: float, u2: float) -> tuple[float, float]:
            for friction, mode in zip(self._frictions, self._modes, strict=True):
                if mode:
                    d1, d2 = friction.direction
                    slip = copysign(abs(d1 * v1 + d2 * v2), mode)
                    position = d1 * q1 + d2 * q2
                    pressing = 0.0 if friction.load_axis is None else abs(load[friction.load_axis])
                    torque = mode * friction.level(slip, position, pressing)
                    u1, u2 = u1 - d1 * torque, u2 - d2 * torque
            return slide(q1, q2, v1, v2, u1, u2)

        def rate_with_stuck(
            q1: float, q2: float, v1: float, v2: float, u1: float, u2: float
        ) -> tuple[float, float]:
            torques = self._holding((q1, q2, v1, v2), u1, u2)
            for index, torque in torques.items():
                d1, d2 = self._frictions[index].direction
                u1, u2 = u1 + d1 * torque, u2 + d2 * torque
            return rate(q1, q2, v1, v2, u1, u2)

        return rate_with_stuck if stuck else rate

    def _first_crossing(
        self, rate: Callable, state: State, after: State, u1: float, u2: float, h: float
    ) -> tuple[int, float] | None:
        """The first sliding pin to turn round within `h` and when [s], by regula falsi on the step length."""
        first: tuple[int, float] | None = None
        for index, (friction, mode) in enumerate(zip(self._frictions, self._modes, strict=True)):
            d1, d2 = friction.direction
            if not mode or mode * (d1 * after[2] + d2 * after[3]) >= 0.0:
                continue
            low, high = 0.0, h
            slip_low, slip_high = d1 * state[2] + d2 * state[3], d1 * after[2] + d2 * after[3]
            for _ in range(8):
                part = low - slip_low * (high - low) / (slip_high - slip_low)
                if not low < part < high:
                    break
                there = rk4(rate, state, u1, u2, part)
                slip = d1 * there[2] + d2 * there[3]
                if mode * slip >= 0.0:
                    low, slip_low = part, slip
                else:
                    high, slip_high = part, slip
                if abs(slip) < 1e-12:
                    break
            part = low if abs(slip_low) < abs(slip_high) else high
            if first is None or part < first[1]:
                first = (index, part)
        return first

    def _pinned(self, state: State) -> State:
        """Takes rounding errors out of the slip speed of stuck pins, by an impulse along each."""
        stuck = [i for i, mode in enumerate(self._modes) if mode == 0]
        if not stuck:
            return state
        q1, q2, v1, v2 = state
        if len(stuck) > 1:
            return q1, q2, 0.0, 0.0
        d1, d2 = self._frictions[stuck[0]].direction
        m11, m12, m22, _ = self._mass(state)
        w1, w2 = m22 * d1 - m12 * d2, m11 * d2 - m12 * d1
        impulse = (d1 * v1 + d2 * v2) / (d1 * w1 + d2 * w2)
        if not d2:
            return q1, q2, 0.0, v2 - w2 * impulse
        v1 -= w1 * impulse
        return q1, q2, v1, -d1 * v1 / d2  # exactly on d . v = 0

    def _mass(self, state: State) -> tuple[float, float, float, float]:
        s = self._structure
        m12 = s.m12 * cos(state[1] - state[0])
        return s.m11, m12, s.m22, s.m11 * s.m22 - m12 * m12

    @staticmethod
    def _level(friction: Friction, slip: float, state: State, load: tuple[float, float]) -> float:
        position = friction.direction[0] * state[0] + friction.direction[1] * state[1]
        pressing = 0.0 if friction.load_axis is None else abs(load[friction.load_axis])
        return friction.level(slip, position, pressing)
