"""Scores of a task as people read them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from workbench.bundle import PolicyBundle

#: How the name of a score ends, and the unit that this says; longer endings first.
_UNITS = {"_rad_s": "rad/s", "_m_s": "m/s", "_rad": "rad", "_n": "N", "_m": "m", "_s": "s"}
_WORDS = {"rmse": "RMSE"}


def score_words(name: str) -> tuple[str, str]:
    """Return a score's name in words and its unit: ``"hip_rmse_rad"`` becomes ``("hip RMSE", "rad")``.

    The unit is empty where the name states none.
    """
    ending = next((e for e in _UNITS if name.endswith(e)), "")
    words = name.removesuffix(ending).split("_")
    return " ".join(_WORDS.get(word, word) for word in words), _UNITS.get(ending, "")


def told_scores(scores: Mapping[str, float]) -> Iterator[tuple[str, str, float]]:
    """Yield each score's name in words, its unit and its value."""
    for name, value in scores.items():
        yield *score_words(name), value


def trained_in(bundle: PolicyBundle) -> str:
    """Return in which tree a policy was trained, in words."""
    from workbench.report.response import words_of

    return "a tree fitted to its loops" if bundle.control.map else f"the variant {words_of(bundle.variant)}"
