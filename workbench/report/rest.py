"""What an improvement leaves above the noise, in one sentence."""

from __future__ import annotations

from workbench.core import Improvement

from .wording import share_phrase


def rest_sentence(result: Improvement) -> str:
    """Why it stops above the noise floor, and where what stays sits; empty where it reaches the floor."""
    if result.verdict == "consistent":
        return ""
    last = result.after if result.steps else result.before
    most = max(last.where, key=lambda s: s.share, default=None) if last is not None else None
    if not result.steps or result.nearest:  # the verdict says already that nothing explains it
        return "" if most is None else f"Of the error above the noise, {share_phrase(most)}."
    where = "" if most is None else f", of which {share_phrase(most)}"
    if result.diagnosis is not None and result.diagnosis.stopped == "budget":
        return f"The search ended before it had tried everything for the rest{where}."
    return f"Nothing that was tried explains the rest{where}."
