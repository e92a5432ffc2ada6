"""All drives of a configuration and the machines they turn, worked row by row."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.can import CanConfig, Frame, make_drive
from workbench.core import InputError

from .hidden import HiddenEffect
from .live import ROW, LiveLeg, LiveShaft, Plant
from .virtual_leg import Sensors
from .virtual_motor import VirtualMotor

#: Full scale of drives whose ranges are to be read from them.
_OWN = (12.5, 45.0, 25.0)


class MotorBank:
    """Virtual motors: every mechanism of two axes is a reference leg, every other axis a lone actuator.

    Args:
        config: the buses and drives.
        hidden: effects in every leg.
        seed: of sensor noise; each machine draws its own.
        sensors: noise and resolution.
        row: one cycle of the drives' control [s].

    Raises:
        InputError: a mechanism that is no leg.
    """

    def __init__(
        self,
        config: CanConfig,
        hidden: Sequence[HiddenEffect] = (),
        seed: int = 0,
        sensors: Sensors | None = None,
        row: float = ROW,
    ) -> None:
        self.row = row
        self.motors = {
            m.axis: VirtualMotor(m.axis, make_drive(m, _OWN if m.reads_ranges else None), m.sign, m.offset)
            for m in config.motor
        }
        self._plants: list[tuple[Plant, list[VirtualMotor]]] = []
        free = list(config.axes)
        for k, mechanism in enumerate(config.mechanism):
            if len(mechanism.axes) != 2:
                remedy = "virtual motors turn legs of two axes, or lone actuators"
                raise InputError(
                    f"'{mechanism.model}' has {len(mechanism.axes)} axes", file=config.source,
                    column="mechanism.axes", remedy=remedy,
                )  # fmt: skip
            leg = LiveLeg(hidden, seed=1000 * seed + k, sensors=sensors, row=row)
            self._plants.append((leg, [self.motors[axis] for axis in mechanism.axes]))
            free = [axis for axis in free if axis not in mechanism.axes]
        for k, axis in enumerate(free):
            shaft = LiveShaft(seed=1000 * seed + 500 + k, sensors=sensors, row=row)
            self._plants.append((shaft, [self.motors[axis]]))

    def respond(self, now: float) -> list[tuple[str, Frame]]:
        """Answers between rows to what was heard, by what sensors showed last: axis and frame.

        Torque changes with the next row.
        """
        said: list[tuple[str, Frame]] = []
        for plant, motors in self._plants:
            heard = [k for k, motor in enumerate(motors) if motor.has_heard]
            if not heard:
                continue
            looks = plant.look()
            for k in heard:
                motors[k].obey(now)
                said += [(motors[k].axis, frame) for frame in motors[k].answer(looks[k], now, 0.0)]
        return said

    def work(self, now: float) -> list[tuple[str, Frame]]:
        """One row that begins now [s]; returns what the motors say: axis and frame."""
        said: list[tuple[str, Frame]] = []
        for plant, motors in self._plants:
            for motor in motors:
                motor.obey(now)
            before = plant.look()
            plant.command([motor.torque(look) for motor, look in zip(motors, before, strict=True)])
            # most rows nobody is asked: what the sensors show just behind the edge is not needed then
            after = plant.look() if any(motor.asked for motor in motors) else before
            for motor, look in zip(motors, after, strict=True):
                said += [(motor.axis, frame) for frame in motor.answer(look, now, self.row)]
            plant.advance()
        return said
