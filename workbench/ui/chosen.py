"""The selected model and recordings."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.comparison import Replay
from workbench.core import Recording
from workbench.models import Model


@dataclass(frozen=True)
class Chosen:
    """The selected model and recordings.

    Attributes:
        model_label, labels: names on the shelf.
        held_out: the label of the recording that judges a diagnosis; None where none does.
        model: as its file has it.
        recordings: as they are replayed, in the order of `labels`.
        replay: how models are run on them.
    """

    model_label: str
    labels: tuple[str, ...]
    held_out: str | None
    model: Model
    recordings: tuple[Recording, ...]
    replay: Replay

    def split(self) -> tuple[list[Recording], list[Recording]]:
        """Return the recordings to fit, and those held out."""
        pairs = list(zip(self.labels, self.recordings, strict=True))
        return [r for name, r in pairs if name != self.held_out], [
            r for name, r in pairs if name == self.held_out
        ]
