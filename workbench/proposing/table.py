"""Content of a file before its meaning is known: columns with names, perhaps units, perhaps a clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Table:
    """Columns of one length, as `workbench.recordings` could read them or as they have to be written anew.

    Attributes:
        file: where they come from.
        columns: name -> values (N,) in the file's own unit; an empty cell is NaN.
        units: name -> unit as the file states it, where it does.
        plain: whether the recording reader understands the file as it stands, by these names.
        clock: name of the column that is the log's own clock in seconds, where the log has one.
        notes: what was done to bring the file into this form, one sentence each.
        joints: name -> the joint that the file says the column is of, where it does.
        series: where the rows are those of one series of several, all of them.
    """

    file: Path
    columns: Mapping[str, np.ndarray]
    units: Mapping[str, str] = field(default_factory=dict)
    plain: bool = False
    clock: str | None = None
    notes: tuple[str, ...] = ()
    joints: Mapping[str, str] = field(default_factory=dict)
    series: tuple[LoggedSeries, ...] = ()

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))


@dataclass(frozen=True)
class LoggedSeries:
    """Columns that share one clock, as one topic of a log has them.

    Attributes:
        stamps: seconds, shape (K,), not decreasing.
        columns: name -> values (K,).
    """

    stamps: np.ndarray
    columns: Mapping[str, np.ndarray]
