"""Drives with one frame per setpoint, in fields of some bits, and one frame per answer."""

from __future__ import annotations

from .messages import Carried, Fields


class Packed:
    """Common part of such protocols.

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
        """Return the resolution of the torque in a frame [N m]."""
        return self.fields.torque.step

    @property
    def exchange(self) -> tuple[Carried, ...]:
        """Return the frames of one exchange."""
        return Carried(8, self.extended), Carried(self.length, self.extended)
