"""An emergency stop on a bus: the button permits motion frame by frame; all else, or silence, stops.

Its frame's first byte is 1 as long as motion is permitted. Every other first byte stops, and so does silence:
a button whose cable is torn off, or whose battery is empty, is a pressed one.
"""

from __future__ import annotations

from workbench.can import CanConfig, Frame

_PERMITTED = 1


class StopInput:
    """State of the button; without one in the configuration nothing stops.

    Args:
        config: where it is.

    Attributes:
        bus: of the button; empty without one.
    """

    def __init__(self, config: CanConfig) -> None:
        self._table = config.stop if config.stop and config.stop.bus else None
        self.bus = self._table.bus if self._table else ""
        self._heard = float("-inf")  # when motion was last permitted [s]
        self._refused = False

    def take(self, frame: Frame, stamp: float) -> bool:
        """Process one frame of its bus; return whether it comes from the button."""
        if self._table is None or frame.extended or frame.id != self._table.id:
            return False
        if frame.data[:1] == bytes([_PERMITTED]):
            self._heard = max(self._heard, stamp)
        else:
            self._refused = True
        return True

    def said(self, now: float) -> str | None:
        """Return the reason to stop, if there is one; a press counts until it was asked for."""
        if self._table is None:
            return None
        refused, self._refused = self._refused, False
        if refused:
            return "the button"
        return "a missing signal of the button" if now - self._heard > self._table.silent_s else None
