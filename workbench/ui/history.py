"""The changes made to a model, one after another, to go back and forth in."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field

from workbench.models import Model


@dataclass
class History:
    """Models from the one given to the last change; `at` is where one stands.

    Changes of one `knob` that follow each other, as a slider makes them, are one step.
    """

    given: Model
    steps: list[tuple[str, Model]] = field(default_factory=list)
    at: int = 0
    _knob: Hashable = None

    @property
    def current(self) -> Model:
        """The model as it is now."""
        return self.steps[self.at - 1][1] if self.at else self.given

    @property
    def changed(self) -> bool:
        """Whether it is another than the one given."""
        return self.current is not self.given

    def change(self, what: str, model: Model, knob: Hashable = None) -> None:
        """Make a change; what had been undone is gone."""
        if knob is None or knob != self._knob or not self.at:
            self.at += 1
        self.steps = [*self.steps[: self.at - 1], (what, model)]
        self._knob = knob

    def settle(self) -> None:
        """The knob was let go: its next move is a step of its own."""
        self._knob = None

    @property
    def before(self) -> str | None:
        """What `undo` would take back; None where there is nothing."""
        return self.steps[self.at - 1][0] if self.at else None

    @property
    def after(self) -> str | None:
        """What `redo` would do again; None where there is nothing."""
        return self.steps[self.at][0] if self.at < len(self.steps) else None

    def undo(self) -> None:
        """One step back, if there is one."""
        self.at, self._knob = max(self.at - 1, 0), None

    def redo(self) -> None:
        """One step forth, if there is one."""
        self.at, self._knob = min(self.at + 1, len(self.steps)), None
