"""The root of every error that a user can cause or meet, and its kinds."""

from __future__ import annotations

from pathlib import Path

from .text import plain

_LONGEST = 1200  # characters; a name in a file may be of any length


class WorkbenchError(Exception):
    """Root of all errors raised on purpose; its text is one clear line, whatever a file contains."""

    exit_code = 2

    def __init__(self, text: str = "") -> None:
        line = plain(" ".join(text.split()))
        cut = f"{line[: _LONGEST // 2]} ... {line[-_LONGEST // 2 :]}"
        super().__init__(line if len(line) <= _LONGEST else cut)


class InputError(WorkbenchError):
    """An input is wrong: the message says where it is and what to do about it.

    Args:
        problem: what is wrong, in one clause.
        file: the offending file.
        column: the offending column or key; without a file the argument.
        row: the offending data row, counted from 1 as an editor shows it below the header.
        remedy: what to do.
    """

    def __init__(
        self,
        problem: str,
        *,
        file: str | Path | None = None,
        column: str | None = None,
        row: int | None = None,
        remedy: str = "",
    ) -> None:
        self.problem, self.file, self.column, self.row = problem, file, column, row
        self.remedy = remedy
        where = [str(file)] if file is not None else []
        named = "key" if file is not None and str(file).endswith(".toml") else "column"
        named = "argument" if file is None else named
        named = "option" if column and column.startswith("--") else named
        where += [f"{named} '{column}'"] if column is not None else []
        where += [f"row {row}"] if row is not None else []
        text = f"{', '.join(where)}: {problem}" if where else problem
        if remedy:  # behind a question stands a sentence of its own
            asks = text.endswith("?")
            text = f"{text} {remedy[0].upper()}{remedy[1:]}" if asks else f"{text}; {remedy}"
        super().__init__(text)


class SimulationError(WorkbenchError):
    """A simulation became unstable or could not run: the message names model, recording, time and value."""
