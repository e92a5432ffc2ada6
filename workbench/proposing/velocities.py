"""Velocities as derivatives of positions: to which axis each belongs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .assignment import filled
from .clean import Clean
from .draft import Draft
from .match import Relation, derivative
from .proposal import Question


def derivatives(rows: Clean, columns: dict[str, list[str]]) -> list[Relation]:
    """Return the match of each axis' position and velocity; none if no velocity was logged."""
    if "velocity" not in columns:
        return []
    return [derivative(*_pair(rows, columns, i)) for i in range(len(columns["position"]))]


def uncross(
    draft: Draft, rows: Clean, columns: dict[str, list[str]], axes: Sequence[str]
) -> dict[str, list[str]]:
    """Return the columns with swapped velocities corrected or asked about."""
    if len(axes) < 2 or "velocity" in draft.answers.columns or "velocity" not in columns:
        return columns
    n = len(axes)
    likeness = np.array(
        [[derivative(*_pair(rows, columns, i, j)).likeness for j in range(n)] for i in range(n)]
    )
    best = likeness.argmax(axis=1)
    bad = [i for i in range(n) if best[i] != i and likeness[i, best[i]] > 0.95 and likeness[i, i] < 0.8]
    if len(bad) < 2 or sorted(best[bad]) != bad:
        return columns
    order = list(range(n))
    for i in bad:
        order[i] = int(best[i])
    pair = " and ".join(f"'{axes[i]}'" for i in bad)
    moved = [columns["velocity"][k] for k in order]
    if _reference_agrees(rows, columns, bad):
        draft.notes.append(
            f"The velocity columns of {pair} are swapped: after an exchange, they are the derivatives."
        )
        draft.assume("swap", f"velocity of {pair}", 0.97, "positions follow their own references")
        return {**columns, "velocity": moved}
    crossed = ",".join(moved)
    draft.questions.append(
        Question(
            "column.velocity",
            f"Columns of {pair} are swapped: each velocity is the derivative of the other position. "
            "Which are wrong?",
            (crossed, ",".join(columns["velocity"])),
            "",
            f"--column velocity={crossed} if the velocities are, else --column position="
            + ",".join(columns["position"][order.index(k)] for k in range(n)),
        )
    )
    return {**columns, "velocity": moved}


def _reference_agrees(rows: Clean, columns: dict[str, list[str]], bad: list[int]) -> bool:
    if "position_reference" not in columns:
        return False
    alike = [
        np.corrcoef(
            filled(rows.columns[columns["position"][i]]),
            filled(rows.columns[columns["position_reference"][i]]),
        )[0, 1]
        for i in bad
    ]
    return bool(min(alike) > 0.8)


def _pair(rows: Clean, columns: dict[str, list[str]], i: int, j: int | None = None) -> tuple:
    """Position of axis i and velocity of axis j, empty cells bridged."""
    q = filled(rows.columns[columns["position"][i]])
    return q, filled(rows.columns[columns["velocity"][i if j is None else j]])
