"""The changes of a model in their order, for undo and redo."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field

from workbench.models import Model


@dataclass
class History:
    """Models from the given one to the last change; `at` is the present place.

    Changes of one `knob` that follow each other, as a slider makes them, are one step.
    """

    given: Model
    steps: list[tuple[str, Model]] = field(default_factory=list)
    at: int = 0
    _knob: Hashable = None

    @property
    def current(self) -> Model:
        """Return the present model."""
        return self.steps[self.at - 1][1] if self.at else self.given

    @property
    def changed(self) -> bool:
        """Return whether the model differs from the given one."""
        return self.current is not self.given

    def change(self, what: str, model: Model, knob: Hashable = None) -> None:
        """Add a change; undone changes are deleted."""
        if knob is None or knob != self._knob or not self.at:
            self.at += 1
        self.steps = [*self.steps[: self.at - 1], (what, model)]
        self._knob = knob

    def settle(self) -> None:
        """End the movement of a slider: its next movement is a new step."""
        self._knob = None

    @property
    def before(self) -> str | None:
        """Return what `undo` would undo; None if there is nothing."""
        return self.steps[self.at - 1][0] if self.at else None

    @property
    def after(self) -> str | None:
        """Return what `redo` would do again; None if there is nothing."""
        return self.steps[self.at][0] if self.at < len(self.steps) else None

    def undo(self) -> None:
        """Go one step back, if there is one."""
        self.at, self._knob = max(self.at - 1, 0), None

    def redo(self) -> None:
        """Go one step forward, if there is one."""
        self.at, self._knob = min(self.at + 1, len(self.steps)), None
