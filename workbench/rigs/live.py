"""Virtual hardware that is driven from outside, row by row: a leg, or a single actuator.

A row is one cycle of a drive's control, short against any loop. The delay T_d of the reference leg is that
of the loop around it, which a loop over a bus makes itself: it is left out. What an effect adds to it stays.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp
from typing import Protocol

import numpy as np

from workbench.core import SimulationError

from .bench import shaft_constants
from .drive import Drive
from .experiments import HOLD
from .hidden import HiddenEffect, install
from .machine import DRIVE_DELAY, TORQUE_LIMIT, Machine, rows_ahead, unmeasured
from .moving_leg import moving_leg
from .sensing import Sensing
from .virtual_leg import Sensors, _watched_row

ROW = 0.25e-3  # s

#: Angle [rad], speed [rad/s] and torque [N m] of one axis.
Look = tuple[float, float, float]


class Plant(Protocol):
    """Motors and their load; torques and readings in actuator coordinates."""

    axes: int

    def look(self) -> list[Look]:
        """Return the present readings of encoders and current sensors, one per axis."""
        ...

    def command(self, torque: Sequence[float]) -> None:
        """Set the torques of the row that begins [N m], so that readings show them.

        Those of the last call before the row is simulated hold.
        """
        ...

    def advance(self) -> None:
        """Simulate one row."""
        ...


class LiveLeg:
    """The reference leg on its stand, two motors.

    Args:
        hidden: effects that it has beyond the nominal model.
        seed: of sensor noise and disturbances.
        sensors: noise and resolution.
        start: joint angles at rest (2,) [rad].
        row: [s].

    Raises:
        SimulationError: these effects cannot be in one leg, or sit in the loop, which is not here.
    """

    axes = 2

    def __init__(
        self,
        hidden: Sequence[HiddenEffect] = (),
        seed: int = 0,
        sensors: Sensors | None = None,
        start: Sequence[float] = tuple(HOLD),
        row: float = ROW,
    ) -> None:
        machine = Machine()
        for effect in hidden:
            install(effect, machine)
        machine.delay = max(0.0, machine.delay - DRIVE_DELAY)
        if {*machine.kp_scale, *machine.kd_scale} != {1.0}:
            raise SimulationError("wrong gains belong to the loop: set them in its configuration")
        self._generator = np.random.default_rng([seed, 31])
        self._sensors, self._row = sensors or Sensors(), row
        self._leg, self._drive = moving_leg(machine), Drive(machine, row, self._generator)
        hip, knee = start
        self._state = self._leg.start(hip, hip + knee)
        self._seen = self._leg.motors(self._state)
        self._sensing = Sensing(machine, row, self._seen)
        self._bias = self._unmeasured(machine).tolist()
        self._count, self._commanded = 0, False
        self._shown = self._measure()

    def look(self) -> list[Look]:
        """Return the present readings of encoders and current sensors."""
        q1, q2, w1, w2 = self._shown
        s, (t1, t2) = self._sensors, self._drive.torque
        if s.encoder:
            q1, q2 = round(q1 / s.encoder) * s.encoder, round(q2 / s.encoder) * s.encoder
        n = self._generator.standard_normal(4).tolist()
        w1, w2 = w1 + s.velocity_noise * n[0], w2 + s.velocity_noise * n[1]
        return [(q1, w1, t1 + s.torque_noise * n[2]), (q2, w2, t2 + s.torque_noise * n[3])]

    def command(self, torque: Sequence[float]) -> None:
        """Set the torques of the row that begins, so that readings show them."""
        self._drive.command((torque[0], torque[1]), again=self._commanded)
        self._commanded = True

    def advance(self) -> None:
        """Simulate one row.

        Raises:
            SimulationError: the leg ran away.
        """
        bias = self._bias[self._count % len(self._bias)]
        self._count, self._commanded = self._count + 1, False
        self._state, self._seen = _watched_row(self._leg, self._drive, self._state, bias, self._sensing.look)
        self._shown = self._measure()
        if not abs(self._seen[2]) + abs(self._seen[3]) < 1e3:
            raise SimulationError(f"the leg ran away at {self._count * self._row:.3f} s")

    def _measure(self) -> tuple[float, float, float, float]:
        return self._seen if self._sensing.true else self._sensing.measure(self._seen)

    def _unmeasured(self, machine: Machine) -> np.ndarray:
        """Bias and disturbances (N, 2) of the rows to come [N m]."""
        time = rows_ahead(machine.disturbances, self._row)
        return unmeasured(machine.bias, machine.disturbances, time, self._generator)


class LiveShaft:
    """A single actuator without load, integrated exactly; see `LiveLeg`."""

    axes = 1

    def __init__(self, seed: int = 0, sensors: Sensors | None = None, row: float = ROW) -> None:
        inertia, self._damping = shaft_constants()
        self._generator, self._sensors = np.random.default_rng([seed, 37]), sensors or Sensors()
        self._row, self._lag = row, inertia / self._damping
        self._decay = exp(-row / self._lag)
        self._angle = self._speed = self._torque = 0.0

    def look(self) -> list[Look]:
        """Return the present readings of encoder and current sensor."""
        s, angle = self._sensors, self._angle
        if s.encoder:
            angle = round(angle / s.encoder) * s.encoder
        n = self._generator.standard_normal(2).tolist()
        return [(angle, self._speed + s.velocity_noise * n[0], self._torque + s.torque_noise * n[1])]

    def command(self, torque: Sequence[float]) -> None:
        """Set the torque of the row that begins."""
        self._torque = min(max(torque[0], -TORQUE_LIMIT), TORQUE_LIMIT)

    def advance(self) -> None:
        """Simulate one row."""
        final, speed = self._torque / self._damping, self._speed
        self._speed = final + (speed - final) * self._decay
        self._angle += final * self._row + (speed - final) * (1.0 - self._decay) * self._lag
