"""Which column is time, and in which unit."""

from __future__ import annotations

import re

import numpy as np

from .names import Role
from .proposal import Answers, Question
from .table import Table
from .units import by_step, pint_unit

_WHOLE_STEPS = 0.98


def find_time(table: Table, roles: dict[str, Role], answers: Answers) -> tuple[str | None, str, float]:
    """Return the time column, the reason, and the confidence; None if there is none."""
    stated = answers.columns.get("time")
    if stated:
        return stated[0], "you said so", 1.0
    if table.clock is not None:
        return table.clock, "the log's own clock", 1.0
    named = [n for n in table.columns if roles[n].kind == "time" and _rises(table.columns[n])]
    if named:
        # a clock with the finest stamps, counted since 1970 or from the start
        best = max(named, key=lambda n: (len(np.unique(table.columns[n])), -len(roles[n].joint)))
        return best, "its name; it only rises", 0.99
    rising = [n for n in table.columns if _even(table.columns[n]) and not _counts_rows(table.columns[n])]
    if len(rising) == 1:
        return rising[0], "the one column that rises evenly", 0.93
    return None, "", 0.0


def _rises(values: np.ndarray) -> bool:
    steps = np.diff(values[np.isfinite(values)])
    return len(steps) > 1 and float(np.mean(steps >= 0)) > 0.95 and bool((steps > 0).any())


def _even(values: np.ndarray) -> bool:
    steps = np.diff(values[np.isfinite(values)])
    if len(steps) < 8 or float(np.mean(steps > 0)) < 0.95:
        return False
    return bool(np.quantile(steps, 0.9) < 3 * np.median(steps))


def _counts_rows(values: np.ndarray) -> bool:
    return float(np.mean(np.diff(values) == 1)) > _WHOLE_STEPS


def time_weights(values: np.ndarray, role: Role, answers: Answers) -> tuple[dict[str, float], str]:
    """Return weights of the units of the clock, and their reasons."""
    stated = answers.units.get("time")
    if stated:
        return {pint_unit(stated, "time") or stated: 1.0}, "you said so"
    finite = values[np.isfinite(values)]
    found = by_step(float(np.median(np.diff(finite))), float(finite[0]), len(finite))
    hint = pint_unit(role.unit, "time") if role.unit else ""
    words = [
        pint_unit(w, "time") for w in role.words if re.fullmatch("ms|us|ns|millis|micros|secs?|seconds", w)
    ]
    hint = hint or next((w for w in words if w), "")
    if hint:
        return {**{u: 1e-3 * w for u, w in found.items()}, hint: max(found.values(), default=1.0)}, "its name"
    return found, "rows per second"


def rate_question() -> Question:
    """Return the question to ask if no column is time."""
    text = "No column looks like time. Which one is it, or how many rows per second are there?"
    return Question("rate", text, (), "", "--rate HZ (or --column time=NAME)")
