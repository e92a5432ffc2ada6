"""Rows of a table for a recording: those of one run, and never only a small part without a message."""

from __future__ import annotations

import numpy as np

from workbench.core import InputError

from .clean import Clean, clean
from .draft import FALLBACK_RATE, Draft
from .proposal import Question


def usable_rows(draft: Draft, time: str | None, columns: dict[str, list[str]]) -> Clean:
    """Return rows in order, of one run, with gaps marked.

    Args:
        draft: takes what is noted and asked.
        time: the clock's column, None where rows are counted.
        columns: signal -> the columns that are used.

    Raises:
        InputError: a column without numbers, or too few rows of those that there are.
    """
    used = list(dict.fromkeys(n for names in columns.values() for n in names if n != time))
    data = dict(draft.table.columns)
    if time is None:
        data["t"] = np.arange(len(draft.table)) / (draft.answers.rate_hz or FALLBACK_RATE)
    dead = [n for n in used if not np.isfinite(data[n]).any()]
    for name in dead:
        raise InputError("has no numbers", file=draft.table.file, column=name, remedy="leave it out")
    valid = valid_column(draft)
    if valid:
        measured = data[valid] != 0
        data |= {n: np.where(measured, data[n], np.nan) for n in used}
        draft.notes.append(f"{int((~measured).sum())} rows are not measured, as '{valid}' says.")
    rows = clean(data, time or "t", used, draft.answers.episode)
    if len(next(iter(rows.columns.values()))) < 8:
        remedy = "record more, or correct the time column"
        raise InputError("has fewer than eight usable rows", file=draft.table.file, remedy=remedy)
    draft.notes += rows.notes
    _check_run(draft, rows.runs)
    kept, every = len(next(iter(rows.columns.values()))), len(draft.table)
    if len(rows.runs) == 1 and 2 * kept < every:
        raise InputError(
            f"only {kept} of {every} rows can be used. {' '.join(rows.notes)}", file=draft.table.file,
            remedy="give a table with one row per sample, all columns in it",
        )  # fmt: skip
    return rows


def valid_column(draft: Draft) -> str:
    """Return the column of zeros and ones that says which rows were measured; ``""`` if there is none.

    Raises:
        InputError: the user names one that is not such.
    """
    stated = draft.answers.columns.get("valid", ())
    for name in stated or ("valid",):
        values = draft.table.columns.get(name, np.full(1, np.nan))
        if np.isin(values, (0.0, 1.0)).all() and values.any():
            return name
        if stated:
            raise InputError("is not 0 or 1 in every row", file=draft.table.file, column=name)
    return ""


def _check_run(draft: Draft, runs: tuple[int, ...]) -> None:
    """Ask which run is meant where most rows are of others; a data set's episode was chosen before."""
    asked = draft.answers.episode
    if asked is not None and asked >= len(runs) and draft.table.file.is_file():
        there = f"time restarts {len(runs) - 1} times in it" if len(runs) > 1 else "time never restarts"
        remedy = f"give --episode from 0 to {len(runs) - 1}" if len(runs) > 1 else "leave out --episode"
        raise InputError(f"has no run {asked}: {there}", file=draft.table.file, remedy=remedy)
    if asked is None and 2 * max(runs) < sum(runs):
        best = int(np.argmax(runs))
        sizes = ", ".join(map(str, runs[:8])) + (" and more" if len(runs) > 8 else "")
        text = f"Time restarts: there are {len(runs)} runs of {sizes} rows. Which one, counted from 0?"
        choices = tuple(str(k) for k in range(min(len(runs), 8)))
        draft.questions.append(Question("episode", text, choices, str(best), f"--episode {best}"))
