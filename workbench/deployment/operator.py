"""What people command a loop: to move, and to stop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass
class Operator:
    """The commands of a person.

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
        """Press the emergency stop."""
        self.stop, self.pressed_by = True, self.pressed_by or what

    def look(self) -> None:
        """Check all inputs that may press it."""
        for watch in self.watches:
            if said := watch():
                self.press(said)
