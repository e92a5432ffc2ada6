"""Positions as shares of a joint's range: some robots log -100 to 100, which numbers alone do not show."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .clean import Clean
from .draft import Draft
from .proposal import Question

_MOST = 100.5  # of a part of a range
_AT_END = 3  # rows that are exactly there, as degrees are not
_LEAST = 7.0  # below, such numbers are radians


def ask_range(draft: Draft, rows: Clean, positions: Sequence[str], units: Sequence[str]) -> None:
    """Ask whether degrees may be shares of a range, which LeRobot data sets contain by default.

    Args:
        draft: takes the question.
        rows: of the columns that are used.
        positions: columns of the positions.
        units: what they are taken for.
    """
    if {"position", "velocity"} & draft.answers.units.keys() or draft.answers.counts:
        return
    top = max(float(np.nanmax(np.abs(rows.columns[name]))) for name in positions)
    if set(units) != {"deg"} or not _LEAST < top < _MOST:
        return
    if any(draft.roles[name].unit for name in positions):
        return
    if not _servos(draft, rows, positions):
        draft.notes.append(
            f"Only their size, up to {top:.3g}, suggests that positions are degrees. Values scaled to "
            "each joint's range (-100 to 100) look the same. If they are scaled: --unit "
            "position=1.1*deg,... (half the range over 100)."
        )
        return
    text = (
        f"Positions go up to {top:.3g}: degrees, or scaled to each joint's range (-100 to 100, "
        "LeRobot's default)? The data do not show it. If scaled, give the degrees per unit for each "
        "joint: half its range over 100."
    )
    example = ",".join(["1.1*deg"] * len(positions))
    option = f"--unit position=deg (or e.g. --unit position={example})"
    draft.questions = [q for q in draft.questions if q.key != "unit.position"]
    draft.questions.append(Question("unit.position", text, (), "deg", option))
    draft.unsure("unit of position", 0.6)


def _servos(draft: Draft, rows: Clean, positions: Sequence[str]) -> bool:
    """Whether a log is as such robots write it: in a data set, by their names, or cut off at an end."""
    if (draft.table.file / "meta" / "info.json").is_file():
        return True
    if all(name.lower().endswith(".pos") for name in positions):
        return True
    ends = (rows.columns[name] for name in positions)
    return any(int(np.sum(np.abs(np.abs(x) - 100.0) < 1e-9)) >= _AT_END for x in ends)
