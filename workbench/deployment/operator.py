"""What people ask of a loop: motion, and that it stops."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass
class Operator:
    """What a person asks for.

    Attributes:
        arm: motion.
        stop: the emergency stop is pressed.
        pressed_by: by what, first; empty where nobody said.
        watches: asked every tick; what one says presses the stop.
    """

    arm: bool = False
    stop: bool = False
    pressed_by: str = ""
    watches: list[Callable[[], str | None]] = field(default_factory=list)

    def press(self, what: str) -> None:
        """Presses the emergency stop."""
        self.stop, self.pressed_by = True, self.pressed_by or what

    def look(self) -> None:
        """Asks everybody who may press it."""
        for watch in self.watches:
            if said := watch():
                self.press(said)
