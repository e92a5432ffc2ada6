"""Integrates the leg through one stretch of constant motor torque, including stick and slip.

RK4 with the mode of every dry friction (sticking, or sliding one way) fixed within a step. The step is cut
where a slip speed changes sign, at which the friction either catches the pin or the pin turns round; where a
backlash meets a flank; and where a hysteresis turns back: so every piece is smooth. Steps are a fraction of
the fastest mode's time. So few coordinates are too few for numpy to pay off: this is plain float code.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import copysign
from operator import itemgetter

from workbench.core import SimulationError

from .along import Along, Vector
from .events import TIGHT, State, Switch, crossing, flank, slip
from .flexible import SHANK, THIGH, FlexibleLeg
from .friction import merged
from .hysteresis import Hysteresis
from .machine import Machine
from .place import Law, Passive, Place
from .rk4 import Rate, rk4

Push = Callable[[float, float, float, float], tuple[float, float]]

_STEP = 1e-3 / 3  # largest integration step [s]: a row in three
_PART = 0.25  # a step over the time in which the fastest mode turns by a radian
_SHORTEST = 1e-5  # s
_MAX_EVENTS = 40  # in one step


class Integrator:
    """The leg with actuators; it stores modes and memories between calls, so use one per run.

    Args:
        machine: its mechanical parts.
        push: torque on thigh and shank (2,) [N m] from outside, of their angles and speeds.

    Raises:
        SimulationError: more than two dry frictions, or a spring too stiff to follow.
    """

    def __init__(self, machine: Machine, push: Push | None = None) -> None:
        self.leg = leg = FlexibleLeg(machine)
        self._push = push
        self._frictions = merged(
            [
                replace(f, direction=leg.direction(Place(0, (f.direction[0], f.direction[1]), f.at_pin)))
                for f in machine.frictions
            ]
        )
        self._rubs = [Along(f.direction) for f in self._frictions]
        self._modes: list[int] = []  # of each friction: 0 sticks, 1 and -1 slide; from the first state on
        self._memories = [
            (Along(leg.direction(at)), Hysteresis(torque, stiffness))
            for at, torque, stiffness in machine.hystereses
        ]
        self._passive: list[tuple[Along, Along, Law]] = [
            *((*self._ways(p), p.law) for p in machine.passive),
            *((along, along, memory.torque) for along, memory in self._memories),
        ]
        self._switches = self._list_switches()
        self._smooth = not (self._frictions or self._switches)
        self._step = self._choose_step(machine)

    def _ways(self, passive: Passive) -> tuple[Along, Along]:
        """Directions along which a smooth torque acts, and whose motion it feels."""
        felt = replace(passive.at, direction=passive.feels or passive.at.direction)
        return Along(self.leg.direction(passive.at)), Along(self.leg.direction(felt))

    def _list_switches(self) -> list[Switch]:
        """Where memories turn back and flanks meet; slips of dry friction have modes besides."""
        slips = [slip(along) for along, _ in self._memories]
        gaps = self.leg.gaps()
        return [*slips, *(flank(front, back, side * half) for front, back, half in gaps for side in (1, -1))]

    def _choose_step(self, machine: Machine) -> float:
        # at a reversal a hysteresis is twice as stiff as at first
        springs = [(self.leg.direction(at), 2 * stiffness) for at, _, stiffness in machine.hystereses]
        fastest = self.leg.fastest(springs)
        step = min(_STEP, _PART / max(fastest, 1.0))
        if step < _SHORTEST:
            raise SimulationError(
                f"a mode of the leg oscillates at {fastest:.2g} rad/s, too fast to simulate: "
                "make its spring softer"
            )
        return step

    def start(self, q1: float, q2: float) -> State:
        """Return the state at rest with the motors at `q1`, `q2` [rad] and relaxed springs."""
        q = self.leg.start(q1, q2)
        for along, memory in self._memories:
            memory.start(along.read(q))
        return q, [0.0] * self.leg.size

    def motors(self, state: State) -> tuple[float, float, float, float]:
        """Return angles [rad] and speeds [rad/s] of the motors."""
        (first, second), (q, v) = self.leg.motors, state
        return q[first], q[second], v[first], v[second]

    def advance(self, state: State, u1: float, u2: float, duration: float) -> State:
        """Return the state after `duration` [s] under motor torques `u1`, `u2` [N m], after gain and bias."""
        outside = [0.0] * self.leg.size
        outside[self.leg.motors[0]] += u1
        outside[self.leg.motors[1]] += u2
        steps = max(1, int(duration / self._step + 0.999999))
        h = duration / steps
        load = (abs(u1), abs(u2))
        if not self._modes:
            slips = [along.read(state[1]) for along in self._rubs]
            self._modes = [(slip > 0.0) - (slip < 0.0) for slip in slips]
        if self._smooth:
            rate = self._rate(outside, load)
            for _ in range(steps):
                state = rk4(rate, state, h)
            return state
        for _ in range(steps):
            state = self._cut_step(state, outside, load, h)
        return state

    def _cut_step(self, state: State, outside: Vector, load: tuple[float, float], h: float) -> State:
        """One step, cut at every event."""
        for _ in range(_MAX_EVENTS):
            self.leg.meet(*state)
            if 0 in self._modes:
                self._release(state, outside, load)
            rate = self._rate(outside, load)
            after = rk4(rate, state, h)
            event = self._first_event(rate, state, after, h)
            if event is None:
                return self._settled(after)
            part, rub = event
            state = rk4(rate, state, part)
            if rub is not None:
                self._modes[rub] = 0
            state = self._settled(state)
            h -= part
            if h <= 1e-12:
                return state
        return self._settled(rk4(self._rate(outside, load), state, h))

    def _first_event(
        self, rate: Rate, state: State, after: State, h: float
    ) -> tuple[float, int | None] | None:
        """When the first event within `h` is [s], and which dry friction turns round there, if one does."""
        found: list[tuple[float, int | None]] = []

        def when(switch: Switch, begin: float, end: float) -> float:
            return crossing(lambda part: switch(rk4(rate, state, part)), begin, end, h)

        for rub, (along, mode) in enumerate(zip(self._rubs, self._modes, strict=True)):
            if mode and mode * (end := along.read(after[1])) < 0.0:
                found.append((when(slip(along), along.read(state[1]), end), rub))
        for switch in self._switches:
            begin, end = switch(state), switch(after)
            if begin * end < 0.0 and abs(begin) > TIGHT:
                found.append((when(switch, begin, end), None))
        return min(found, key=itemgetter(0), default=None)

    def _release(self, state: State, outside: Vector, load: tuple[float, float]) -> None:
        """Lets go every stuck friction whose holding torque exceeds its static limit, the worst first."""
        q, v = state
        for _ in self._frictions:
            worst, chosen, way = 0.0, None, 0
            for rub, torque in self._holding(q, self._applied(q, v, outside, load)).items():
                direction = copysign(1.0, -torque)
                excess = abs(torque) - self._level(rub, direction * 0.0, q, load)
                if excess > worst:
                    worst, chosen, way = excess, rub, int(direction)
            if chosen is None:
                return
            self._modes[chosen] = way

    def _applied(self, q: Vector, v: Vector, outside: Vector, load: tuple[float, float]) -> Vector:
        """All torque except that of stuck frictions and inertia (n,) [N m]."""
        t = self.leg.forces(q, v, outside)
        for along, felt, law in self._passive:
            torque = law(felt.read(q), felt.read(v))
            for i, d in along.terms:
                t[i] += d * torque
        if self._push is not None:
            thigh, shank = self._push(q[THIGH], q[SHANK], v[THIGH], v[SHANK])
            t[THIGH] += thigh
            t[SHANK] += shank
        for rub, mode in enumerate(self._modes):
            if mode:
                along = self._rubs[rub]
                torque = mode * self._level(rub, copysign(abs(along.read(v)), mode), q, load)
                for i, d in along.terms:
                    t[i] -= d * torque
        return t

    def _level(self, rub: int, slip: float, q: Vector, load: tuple[float, float]) -> float:
        friction = self._frictions[rub]
        pressing = 0.0 if friction.load_axis is None else load[friction.load_axis]
        return friction.level(slip, self._rubs[rub].read(q), pressing)

    def _holding(self, q: Vector, applied: Vector) -> dict[int, float]:
        """Torque that each stuck friction needs to stay stuck [N m], by index."""
        stuck = [rub for rub, mode in enumerate(self._modes) if mode == 0]
        if not stuck:
            return {}
        free = self.leg.give(q, applied)
        reads = [self._rubs[rub].read for rub in stuck]
        gives = [self.leg.give(q, self._rubs[rub].vector) for rub in stuck]
        w11, n1 = reads[0](gives[0]), -reads[0](free)
        if len(stuck) == 1:
            return {stuck[0]: n1 / w11}
        w12, w22, n2 = reads[0](gives[1]), reads[1](gives[1]), -reads[1](free)
        area = w11 * w22 - w12 * w12
        return {stuck[0]: (w22 * n1 - w12 * n2) / area, stuck[1]: (w11 * n2 - w12 * n1) / area}

    def _rate(self, outside: Vector, load: tuple[float, float]) -> Rate:
        """Acceleration with the modes as they stand now."""
        forces, give, applied = self.leg.forces, self.leg.give, self._applied
        if not (self._passive or self._frictions or self._push):
            return lambda q, v: give(q, forces(q, v, outside))
        if 0 not in self._modes:
            return lambda q, v: give(q, applied(q, v, outside, load))

        def rate(q: Vector, v: Vector) -> Vector:
            t = applied(q, v, outside, load)
            for rub, torque in self._holding(q, t).items():
                for i, d in self._rubs[rub].terms:
                    t[i] += d * torque
            return give(q, t)

        return rate

    def _settled(self, state: State) -> State:
        """Moves the memories on, and takes rounding errors out of the slip speed of what sticks."""
        q, v = state
        for along, memory in self._memories:
            memory.settle(along.read(q))
        stuck = [along for along, mode in zip(self._rubs, self._modes, strict=True) if mode == 0]
        for along in stuck:
            given = self.leg.give(q, along.vector)
            impulse = along.read(v) / along.read(given)
            v = [x - impulse * y for x, y in zip(v, given, strict=True)]
        for along in sorted(stuck, key=lambda along: len(along.terms)):
            *others, (last, factor) = along.terms
            v[last] = -sum(d * v[i] for i, d in others) / factor  # exactly on d . v = 0
        return q, v
