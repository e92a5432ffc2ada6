"""Positions as parts of a joint's range: some robots log -100 to 100, which no numbers tell from degrees."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .clean import Clean
from .draft import Draft
from .proposal import Question

_MOST = 100.5  # of a part of a range
_LEAST = 7.0  # below, such numbers are radians


def ask_range(draft: Draft, rows: Clean, positions: Sequence[str], units: Sequence[str]) -> None:
    """Ask where degrees may be parts of a range: data sets of LeRobot hold these unless told otherwise.

    Args:
        draft: takes the question.
        rows: of the columns that are used.
        positions: columns of the positions.
        units: what they are taken for.
    """
    if "position" in draft.answers.units or not (draft.table.file / "meta" / "info.json").is_file():
        return
    top = max(float(np.nanmax(np.abs(rows.columns[name]))) for name in positions)
    if set(units) != {"deg"} or not _LEAST < top < _MOST:
        return
    text = (
        f"Positions go up to {top:.3g}: degrees, or parts of each joint's range (-100 to 100, as LeRobot has "
        "them unless told otherwise)? Nothing in the data tells. For parts give the degrees of one, half the "
        "range over 100, one a joint."
    )
    example = ",".join(["1.1*deg"] * len(positions))
    option = f"--unit position=deg (or e.g. --unit position={example})"
    draft.questions = [q for q in draft.questions if q.key != "unit.position"]
    draft.questions.append(Question("unit.position", text, (), "deg", option))
    draft.unsure("unit of position", 0.6)
