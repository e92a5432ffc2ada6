"""The error of an improvement that stays above the noise, in one sentence."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.core import Finding, Improvement

from .numbers import interval
from .wording import any_of, capital, effect_phrase, parameter_name, share_phrase


def near_sentence(near: Sequence[Finding]) -> str:
    """Return effects that lower the error but are not certain enough to be named; empty if there are none."""
    if not near:
        return ""
    told = []
    for f in near:
        values = ", ".join(f"{parameter_name(n)} {interval(e)}" for n, e in f.parameters.items())
        told.append(f"{effect_phrase(f.key)} ({values})")
    verb = "lowers the error and is" if len(near) == 1 else "lower the error and are"
    return (
        f"{capital(any_of(told, 'and'))} {verb} not certain: a free function, of the same quantity or "
        "of another, explains as much or more in its place."
    )


def rest_sentence(result: Improvement) -> str:
    """Return why the error stays above the noise floor, and where it is; empty if it reaches the floor."""
    if result.verdict == "consistent":
        return ""
    last = result.after if result.steps else result.before
    most = max(last.where, key=lambda s: s.share, default=None) if last is not None else None
    if not result.steps or result.nearest:  # the verdict says already that nothing explains it
        return "" if most is None else f"Of the squared error above the noise, {share_phrase(most)}."
    where = "" if most is None else f", of which {share_phrase(most)}"
    if result.diagnosis is not None and result.diagnosis.stopped == "budget":
        return f"The search ended before it had tried everything for the rest{where}."
    return f"Nothing that was tried explains the rest{where}."
