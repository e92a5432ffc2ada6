"""The error for a missing column."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

from workbench.core import InputError


def missing_column(column: str, known: Iterable[str], path: Path) -> InputError:
    """Return an error that names the column and the closest existing one."""
    known = [str(k) for k in known]
    close = get_close_matches(column, known, n=1, cutoff=0.5)
    shown = ", ".join(known[:20]) + (", ..." if len(known) > 20 else "")
    remedy = f"did you mean '{close[0]}'?" if close else f"the table has: {shown}"
    return InputError("there is no such column in the table", file=path, column=column, remedy=remedy)
