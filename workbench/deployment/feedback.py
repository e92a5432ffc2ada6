"""Known state of every drive from received frames; frames that do not fit are counted and ignored."""

from __future__ import annotations

from collections import Counter

import numpy as np

from workbench.can import CanConfig, Drive, Fault, FrameError, Parameter, make_drive
from workbench.can import Feedback as Said

from .base import BaseFeedback
from .estop import StopInput
from .network import Arrival

_SLACK = 0.05  # by which a position may step beyond what full speed allows [rad]


class Feedback:
    """Position, velocity, torque at the axes, per drive; arrays (n,).

    Attributes:
        position, velocity, torque: [rad, rad/s, N m]; NaN before the first feedback.
        temperature: [deg C], NaN where none is told.
        stamp: when the feedback was complete on the wire [s]; -inf before the first.
        fault: what each drive reports, in words; empty for nothing.
        faulty: drives that report a fault or that they do not drive.
        base: what is known of the base.
        stop: what an emergency stop on a bus says.
        counts: frames by what they were: feedback, base, parameter, echo, unknown, garbage, old.
    """

    def __init__(self, config: CanConfig) -> None:
        n = len(config.motor)
        self._motors = config.motor
        self.drives: list[Drive] = [make_drive(motor) for motor in config.motor]
        self._on = {
            bus.name: [i for i, m in enumerate(config.motor) if m.bus == bus.name] for bus in config.bus
        }
        self.position, self.velocity, self.torque = np.full((3, n), np.nan)
        self.temperature, self.stamp = np.full(n, np.nan), np.full(n, -np.inf)
        self.faulty, self.fault = np.ones(n, bool), [""] * n
        self.counts: Counter[str] = Counter()
        self._stale = 3 * config.loop.period_s
        self.base = BaseFeedback(config, self._stale)
        self.stop = StopInput(config)
        self._parameters: list[dict[str, float]] = [{} for _ in range(n)]

    def take(self, arrival: Arrival, now: float) -> None:
        """Process one frame that was received at `now` [s]."""
        if arrival.sent:
            self.counts["echo"] += 1
            return
        for index in self._on[arrival.bus]:
            try:
                said = self.drives[index].decode(arrival.frame)
            except FrameError:
                self.counts["garbage"] += 1
                return
            if said is not None:
                self._heard(index, said, arrival.stamp, now)
                return
        if arrival.bus == self.stop.bus and self.stop.take(arrival.frame, arrival.stamp):
            self.counts["stop"] += 1
            return
        base = self.base.take(arrival.frame, arrival.stamp, now) if arrival.bus == self.base.bus else None
        self.counts[base or "unknown"] += 1

    def parameter(self, index: int, name: str) -> float | None:
        """Return the parameter that drive `index` has sent since it was asked."""
        return self._parameters[index].get(name)

    def forget(self, index: int, name: str) -> None:
        """Discard an old answer before a parameter is asked for."""
        self._parameters[index].pop(name, None)

    def replace(self, index: int, drive: Drive) -> None:
        """Use another drive, with the ranges that were read; decoded values are discarded."""
        self.drives[index] = drive
        self.position[index] = self.velocity[index] = self.torque[index] = np.nan

    def age(self, now: float) -> np.ndarray:
        """Return the age of the feedback (n,) by its receive stamp [s]."""
        return now - self.stamp

    def _heard(self, index: int, said: Said | Parameter | Fault, stamp: float, now: float) -> None:
        if isinstance(said, Parameter):
            self.counts["parameter"] += 1
            self._parameters[index][said.name] = said.value
            return
        if isinstance(said, Fault):
            self.counts["feedback"] += 1
            self.faulty[index], self.fault[index] = True, f"fault word {said.number:#x}"
            return
        # reordered, repeated, or too long on its way
        if stamp <= self.stamp[index] or now - stamp >= self._stale or stamp > now + 1e-3:
            self.counts["old"] += 1
            return
        motor = self._motors[index]
        q = motor.sign * said.position + motor.offset
        fastest = self.drives[index].ranges.velocity
        known = np.isfinite(self.position[index])
        if known and abs(q - self.position[index]) > fastest * (stamp - self.stamp[index]) + _SLACK:
            self.counts["garbage"] += 1
            return
        self.counts["feedback"] += 1
        self.position[index], self.stamp[index] = q, stamp
        self.velocity[index], self.torque[index] = motor.sign * said.velocity, motor.sign * said.torque
        self.temperature[index] = np.nan if said.temperature is None else said.temperature
        self.faulty[index] = bool(said.fault) or said.enabled is False
        self.fault[index] = self.drives[index].explain(said.fault) if said.fault else ""
        if said.enabled is False and not said.fault:
            self.fault[index] = "is off"
