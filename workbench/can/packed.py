"""Drives of which one frame has all of a setpoint, in numbers of some bits, and one frame answers."""

from __future__ import annotations

from .messages import Carried, Fields


class Packed:
    """What such protocols have alike.

    Attributes:
        extended: whether identifiers have 29 bits.
        length: of an answer, bytes.
        fields: ranges and steps of a setpoint's numbers.
    """

    extended: bool
    length: int
    fields: Fields

    @property
    def torque_step(self) -> float:
        """What a frame's torque cannot tell apart [N m]."""
        return self.fields.torque.step

    @property
    def exchange(self) -> tuple[Carried, ...]:
        """Frames of one exchange."""
        return Carried(8, self.extended), Carried(self.length, self.extended)
