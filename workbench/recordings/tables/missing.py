"""The error for a missing column."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from workbench.core import InputError
from workbench.core.text import did_you_mean


def missing_column(column: str, known: Iterable[str], path: Path) -> InputError:
    """Return an error that names the column and the closest existing one."""
    known = [str(k) for k in known]
    shown = ", ".join(known[:20]) + (", ..." if len(known) > 20 else "")
    remedy = did_you_mean(column, known) or f"the table has: {shown}"
    return InputError("there is no such column in the table", file=path, column=column, remedy=remedy)
