"""The diagnosis against the textbook: inverse dynamics, least squares, effects added by BIC or AIC."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from baselines import METHODS
from exam.cases import all_cases
from exam.mark import mark
from side_by_side import spread

from .row import Part, Row

Pairs = list[tuple[Mapping[str, Any], Mapping[str, Any]]]
_OTHERS = "least_squares_bic", "least_squares_aic"


def measure(quick: bool) -> list[Row]:
    """Both answer the same cases of the exam."""
    lines = []
    for case in all_cases(0)[: 2 if quick else 24]:
        line = mark(case, {name: METHODS[name] for name in _OTHERS})
        lines.append(line)
    return rows(lines)


def rows(lines: Sequence[Mapping[str, Any]]) -> list[Row]:
    """From marks of the exam that have the other methods' too."""
    found = []
    for name in _OTHERS:
        short = name.rpartition("_")[2].upper()
        both = [(line, line["others"].get(name)) for line in lines if "failed" not in line]
        pairs = [(own, other) for own, other in both if other and "failed" not in other]
        over = f"least squares, {short}"
        found += [
            Row(f"good answers to {len(pairs)} cases", over, _counts(pairs, "good")),
            Row("false findings in them", over, _counts(pairs, "false_findings")),
            *_errors(pairs, over),
            Row("CPU time", over, str(spread([own["cpu_s"] / max(x["cpu_s"], 0.01) for own, x in pairs]))),
        ]
    return found


def _counts(pairs: Pairs, what: str) -> str:
    ours, theirs = (sum(int(pair[k][what]) for pair in pairs) for k in (0, 1))
    return f"{ours} over {theirs}"


def _errors(pairs: Pairs, over: str) -> list[Row]:
    """Errors that are left on held-out motion; models that nothing was added to keep theirs."""
    both = [(own["after"], other["after"]) for own, other in pairs if own["after"] and other["after"]]
    if not both:
        return []
    ratios = np.array([one / other for one, other in both])
    return [Row(f"error that is left on held-out motion, {len(both)} cases", over, str(spread(ratios)))]


PART = Part(
    "selection",
    "The diagnosis against least squares and an information criterion",
    "Filtered inverse dynamics of the same leg, linear least squares and forward selection by BIC or AIC, on "
    "the first cases of the exam. It needs no simulation, so its time is next to nothing; what counts is "
    "what the answers are worth.",
    measure,
    "python benchmarks/hidden_effects.py --out marks.jsonl --others least_squares_bic least_squares_aic",
)
