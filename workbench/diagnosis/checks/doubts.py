"""Doubts: what a diagnosis would refuse in these recordings, as lines beside a result that is shown
anyway.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice

from workbench.comparison import matched
from workbench.core import InputError, Recording
from workbench.models import Model
from workbench.recordings import Log

from ..policy import POLICY
from .loops import refuse_coordinates
from .sign_check import refuse_wrong_sign_of_torque
from .units import refuse_unit


def doubts(model: Model, sources: Sequence[Recording | Log]) -> tuple[str, ...]:
    """Return lines about loop coordinates, guessed units and signs that contradict the recordings.

    Only what the torque along the measured motion shows is asked, which takes a fraction of a second.

    Args:
        model: what is believed.
        sources: recordings and logs of its axes.

    Raises:
        InputError: recordings that do not fit the model.
    """
    held = [r for source in sources for r in _held(source)]
    recordings = matched(model, held)
    lines = []
    for refuse in (refuse_coordinates, refuse_unit, refuse_wrong_sign_of_torque):
        try:
            refuse(model, recordings)
        except InputError as error:
            names = ", ".join(dict.fromkeys(r.name for r in held if r.source == error.file))
            lines.append(f"{names}: {error.problem}; `diagnose` refuses this: {error.remedy}")
    return tuple(lines)


def _held(source: Recording | Log) -> list[Recording]:
    if isinstance(source, Recording):
        return [source]
    return [piece.recording for piece in islice(source.stretches(POLICY.check_seconds, 0.0), 1)]
