"""Delays: nearly equivalent to each other in a loop, and resolved by a log in whole rows only.

The best delay found for one is tried for the others; fits are tried across the edge of a row, where
derivatives fail.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import SignalStage, effect_named, kinds, places
from workbench.models import AppliedEffect

from ..hypothesis import Hypothesis, applied_effect, blocks, moved, step_bounds
from .bounded_least_squares import solve
from .normal_equations import Normal

_OVER_STEP = 1e-6  # of a row, beyond its edge


def is_delay(key: EffectKey) -> bool:
    """Return whether an effect is only a delay or a lag."""
    return kinds.is_pure_delay(effect_named(key.effect))


def with_delay(hypothesis: Hypothesis, key: EffectKey, seconds: float) -> Hypothesis:
    """Return the hypothesis with its last effect delayed by that many seconds."""
    (parameter,) = effect_named(key.effect).parameters
    late = applied_effect(hypothesis.base, AppliedEffect(key), {parameter.name: seconds})
    return replace(hypothesis, free=(*hypothesis.without(key).free, late))


def one_delay_for_two(hypothesis: Hypothesis, one: AppliedEffect, other: AppliedEffect) -> list[Hypothesis]:
    """Hypotheses with one delay, as long as both, in place of two: the loop depends only on their sum."""
    rest = hypothesis.without(one.key).without(other.key)
    seconds = sum(value for a in (one, other) for value in a.values.values())
    there = {a.key for a in rest.free}
    axes = {None, one.key.axis, other.key.axis}
    keys = [key for key in places(hypothesis.base) if is_delay(key) and key not in there and key.axis in axes]
    return [with_delay(rest, key, seconds) for key in keys]


def retry_at_best_delay(
    tried: Sequence[Hypothesis], values: Sequence[float], near: Sequence[bool] | np.ndarray
) -> dict[int, Hypothesis]:
    """Return hypotheses, by index, that restart poorly fitted delays at the best delay found.

    The loop hardly depends on which delay it is, only on its length. One fit starts near, another has far to
    go while all other effects change too.

    Args:
        tried: hypotheses, what is tried as their last effect.
        values: what each leaves.
        near: which of them are still competing.
    """
    late = [k for k, h in enumerate(tried) if h.free and is_delay(h.free[-1].key)]
    best = min(late, key=lambda k: values[k], default=None)
    if best is None or not near[best]:
        return {}
    led = tried[best]
    (seconds,) = led.free[-1].values.values()
    return {
        k: with_delay(led.without(led.free[-1].key), tried[k].free[-1].key, seconds)
        for k in late
        if not near[k] and {a.key for a in tried[k].free[:-1]} == {a.key for a in led.free[:-1]}
    }


def has_whole_row_delay(hypothesis: Hypothesis) -> bool:
    """Return whether one of its effects is a delay between command and torque."""
    return any(map(_is_a_command_s, hypothesis.free))


def _is_a_command_s(applied: AppliedEffect) -> bool:
    effect = effect_named(applied.key.effect)
    return (
        is_delay(applied.key)
        and effect.stage is SignalStage.COMMAND
        and "time" in effect.parameters.nonlinear
    )


def across_row_edge(hypothesis: Hypothesis, equations: Normal, step: float) -> list[Hypothesis]:
    """Return hypotheses with a delay just inside the rows before and after, with all other unknowns solved
    for it.

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
