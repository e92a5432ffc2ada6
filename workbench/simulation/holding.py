"""The loop that holds a machine during an excitation, and whether one is needed but missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from workbench.core import InputError, SimulationError
from workbench.frf import Design, Limit
from workbench.models import Model
from workbench.recordings import describe

from .designs import holds, predictor, without_loop


def with_loop_of(model: Model, recording: str | Path) -> Model:
    """Return the model with the loop that a recording states; only the TOML file of the recording is read.

    Raises:
        InputError: it cannot be read, has other axes, or states no loop that holds a posture.
    """
    described = describe(Path(recording))
    axes = tuple(described.contents.axes)
    if axes != tuple(model.axes):
        raise InputError(
            f"its loop is that of {', '.join(axes)}", file=described.path, column="axes",
            remedy=f"give a recording of {', '.join(model.axes)}, in this order",
        )  # fmt: skip
    closed = replace(model, controller=described.controller)
    if not holds(closed):
        raise InputError(
            "states no loop that holds a posture", file=described.path, column="controller",
            remedy="give a recording whose [controller] is of kind pd or cascade_pv",
        )  # fmt: skip
    return closed


def check_held(model: Model, design: Design, limits: Sequence[Limit]) -> None:
    """Refuse a machine without a loop that leaves the range of a joint by itself, without excitation.

    No excitation is small enough for it, and to find that out by shrinking one takes long.

    Raises:
        InputError: it leaves a range, or does not even run.
    """
    ranges = [limit for limit in limits if limit.quantity == "position"]
    if holds(model) or not ranges:
        return
    still = replace(design, trials=design.trials[:1], experiments=0.0 * design.experiments[:1])
    try:
        position = predictor(model, ranges)(still)["position"]
    except SimulationError as error:
        raise without_loop(model, "keeps it from falling") from error
    for limit, values in zip(ranges, position.T, strict=True):
        starts_inside = limit.low < values[0] < limit.high
        if starts_inside and not bool(np.all((limit.low <= values) & (values <= limit.high))):
            raise without_loop(model, f"holds it: with no excitation it leaves the {limit}")
