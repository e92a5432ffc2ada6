"""The loop check: refuses recordings that contradict the stated coordinates of their loop."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.core import InputError, Recording
from workbench.inspection.coordinates import law_elsewhere
from workbench.models import Model


def refuse_coordinates(model: Model, recordings: Sequence[Recording]) -> None:
    """Refuse recordings whose commands follow the stated law in the other coordinates.

    Raises:
        InputError: names the recording.
    """
    for recording in () if model.floats else recordings:
        found = law_elsewhere(recording, model.transmission)
        if found is not None:
            raise InputError(
                f"the loop acts in other coordinates than stated: {found}",
                file=recording.source, column="controller.coordinates",
                remedy=f'write coordinates = "{found.coordinates}"',
            )  # fmt: skip
