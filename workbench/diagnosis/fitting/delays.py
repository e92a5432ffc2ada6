"""Delays of a loop, which are much alike: where one of them fits, another is tried as late."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import Trace, effect_named, places
from workbench.models import AppliedEffect

from ..hypothesis import Hypothesis, applied_effect


def is_delay(key: EffectKey) -> bool:
    """Whether an effect is a delay or a lag, and nothing else."""
    effect = effect_named(key.effect)
    return effect.trace is Trace.DELAY and len(effect.parameters) == 1


def with_delay(hypothesis: Hypothesis, key: EffectKey, seconds: float) -> Hypothesis:
    """With a delay of that many seconds, in place of what it has of it."""
    (parameter,) = effect_named(key.effect).parameters
    late = applied_effect(hypothesis.base, AppliedEffect(key), {parameter.name: seconds})
    return replace(hypothesis, free=(*hypothesis.without(key).free, late))


def one_delay_for_two(hypothesis: Hypothesis, one: AppliedEffect, other: AppliedEffect) -> list[Hypothesis]:
    """In place of two delays one that is as late as both, whichever: the loop sees their sum alone."""
    rest = hypothesis.without(one.key).without(other.key)
    seconds = sum(value for a in (one, other) for value in a.values.values())
    there = {a.key for a in rest.free}
    axes = {None, one.key.axis, other.key.axis}
    keys = [key for key in places(hypothesis.base) if is_delay(key) and key not in there and key.axis in axes]
    return [with_delay(rest, key, seconds) for key in keys]


def retry_at_best_delay(
    tried: Sequence[Hypothesis], values: Sequence[float], near: Sequence[bool] | np.ndarray
) -> dict[int, Hypothesis]:
    """Delays that fell behind, from where the best of those that are tried beside them has come; by number.

    A loop hardly tells one delay from another, but how late it is. One fit begins near and another has still
    far to go, on a way on which all other effects change too.

    Args:
        tried: hypotheses, what is tried as their last effect.
        values: what each leaves.
        near: which of them have not fallen behind the best of all.
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
