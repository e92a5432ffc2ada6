"""Notes about recordings for the reader of a result."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.core import Recording
from workbench.simulation import scored_torque

from .swings import is_free


def notes_of(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Return the notes that a reader of a result on these recordings should know; notes of several
    recordings are combined.
    """
    names: dict[str, list[str]] = {}
    for r in recordings:
        notes = r.notes
        if scored_torque(r) == "torque_command" and not is_free(r):
            notes = (*notes, "torque was not measured behind the drive; the command is compared instead")
        elif scored_torque(r) is None:
            notes = (*notes, "no torque was recorded; position alone is compared")
        for note in notes:
            names.setdefault(note, []).append(r.name)
    return tuple(f"{', '.join(of)}: {note}" for note, of in names.items())
