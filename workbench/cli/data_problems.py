"""Notes on what ``inspect`` finds wrong with recordings, for results that use these recordings unchanged."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from workbench.core import Recording

if TYPE_CHECKING:  # MuJoCo is slow to import, and a shell that completes a word waits for this
    from workbench.models import Model


def data_problems(model: Model, recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Return a note per problem: a wrong clock, unit, sign or swap looks like physics to all else.

    Args:
        model: whose transmission the recordings' coordinates differ by.
        recordings: what was measured.
    """
    from workbench.inspection import inspect

    constant = not model.posture_dependent and len(model.axes) == len(model.joints)
    found = inspect(recordings, transmission=model.transmission if constant else None)
    names: dict[str, list[str]] = {}
    for recording, said in zip(recordings, found.recordings, strict=True):
        for remark in said.remarks:
            if remark.severity == "problem":
                names.setdefault(remark.text.rstrip("."), []).append(recording.name)
    return tuple(
        f"{', '.join(of)}: {text}. This may be the cause of the error; correct it first (workbench inspect)"
        for text, of in names.items()
    )
