"""Delays of a loop, which are nearly equivalent: the best delay found for one is tried for the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import effect_named, kinds, places
from workbench.models import AppliedEffect

from ..hypothesis import Hypothesis, applied_effect


def is_delay(key: EffectKey) -> bool:
    """Whether an effect is a delay or a lag, and nothing else."""
    return kinds.is_pure_delay(effect_named(key.effect))


def with_delay(hypothesis: Hypothesis, key: EffectKey, seconds: float) -> Hypothesis:
    """The hypothesis with its last effect delayed by that many seconds."""
    (parameter,) = effect_named(key.effect).parameters
    late = applied_effect(hypothesis.base, AppliedEffect(key), {parameter.name: seconds})
    return replace(hypothesis, free=(*hypothesis.without(key).free, late))


def one_delay_for_two(hypothesis: Hypothesis, one: AppliedEffect, other: AppliedEffect) -> list[Hypothesis]:
    """Hypotheses with one delay, as long as both, in place of two: the loop depends on their sum alone."""
    rest = hypothesis.without(one.key).without(other.key)
    seconds = sum(value for a in (one, other) for value in a.values.values())
    there = {a.key for a in rest.free}
    axes = {None, one.key.axis, other.key.axis}
    keys = [key for key in places(hypothesis.base) if is_delay(key) and key not in there and key.axis in axes]
    return [with_delay(rest, key, seconds) for key in keys]


def retry_at_best_delay(
    tried: Sequence[Hypothesis], values: Sequence[float], near: Sequence[bool] | np.ndarray
) -> dict[int, Hypothesis]:
    """Hypotheses, by number, that restart delays with a poor fit at the delay of the best one.

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
