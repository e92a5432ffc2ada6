"""Delays that the log resolves in whole rows only: fits across the edge of a row, where derivatives fail."""

from __future__ import annotations

import numpy as np

from workbench.effects import SignalStage, effect_named
from workbench.models import AppliedEffect

from ..hypothesis import Hypothesis, blocks, moved, step_bounds
from .bounded_least_squares import solve
from .delays import is_delay
from .normal_equations import Normal

_OVER_STEP = 1e-6  # of a row, beyond its edge


def has_whole_row_delay(hypothesis: Hypothesis) -> bool:
    """Whether one of its effects is a delay between command and torque."""
    return any(_is_a_command_s(applied) for applied in hypothesis.free)


def _is_a_command_s(applied: AppliedEffect) -> bool:
    effect = effect_named(applied.key.effect)
    return (
        is_delay(applied.key)
        and effect.stage is SignalStage.COMMAND
        and "time" in effect.parameters.nonlinear
    )


def across_row_edge(hypothesis: Hypothesis, equations: Normal, step: float) -> list[Hypothesis]:
    """Hypotheses with a delay just inside the rows before and after, all other unknowns solved for it.

    A torque that is held from row to row and late by three rows and a bit is logged as if it were late by
    four. How much a bit is, the motion alone tells. A fit that has come a little over a whole row, which is
    what most delays are, finds the logged torque a row late, and nothing in its slopes that leads back.

    Args:
        hypothesis: where a fit has ended.
        equations: its normal equations there.
        step: between rows [s].

    Returns:
        Two hypotheses for each delay between command and torque; one where the first row is the nearest.
    """
    low, high = step_bounds(hypothesis)
    out = []
    for applied, block in blocks(hypothesis):
        if not _is_a_command_s(applied):
            continue
        effect = effect_named(applied.key.effect)
        index = block.stop - len(effect.parameters.nonlinear) + effect.parameters.nonlinear.index("time")
        own = hypothesis.base.actuators.delay_s
        rows = (own + applied.values["time"]) / step
        for edge in (np.floor(rows) - _OVER_STEP, np.ceil(rows) + _OVER_STEP):
            change = edge * step - own - applied.values["time"]
            if not low[index] <= change <= high[index]:
                continue
            at = np.arange(len(low)) == index
            held = np.where(at, change, low), np.where(at, change, high)
            out.append(moved(hypothesis, solve(equations, *held)))
    return out
