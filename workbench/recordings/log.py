"""A log too long for the memory: read in pieces, as often as needed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from workbench.core import InputError, Recording

from .checks import check_alive, check_excitation
from .clock import Clock, read_clock
from .convert import seconds
from .read import Described, assemble, describe, load_recording, measured_rows
from .several import recording_files
from .tables.batches import STREAMED, count_rows, read_batches

#: Rows times axes up to which a recording is held as a whole: ten minutes of two axes at 1 kHz.
HELD = 1_200_000
#: The same of rows times axes squared, which tell how small changes go round a loop: a minute of twelve axes.
HELD_COUPLED = 9_000_000
#: Bytes of a table below which it cannot have as many numbers: compressed, and as text.
SMALL, SMALL_TEXT = 1 << 20, 8 << 20
_MATCHING = 12  # rows among which one is looked for at which the loop ticks


@dataclass(frozen=True)
class Stretch:
    """A piece of a log.

    Attributes:
        recording: its rows, those before the piece that it was begun with included; clock from 0.
        start: of the recording in the log [s].
        lead: rows that come before the piece.
    """

    recording: Recording
    start: float
    lead: int


@dataclass(frozen=True)
class Log:
    """A recording that stays in its file.

    `rows` are the table's.
    """

    described: Described
    rows: int

    @property
    def name(self) -> str:
        """The recording's name."""
        return self.described.contents.name or self.described.path.stem

    @property
    def axes(self) -> tuple[str, ...]:
        """Return the names of its axes."""
        return tuple(self.described.contents.axes)

    @property
    def source(self) -> Path:
        """Return its TOML file."""
        return self.described.path

    @cached_property
    def clock(self) -> Clock:
        """Return the clock of the whole log, checked.

        Raises:
            InputError: as `load_recording`, of the time column.
        """
        d, path, table = self.described.contents, self.described.path, self.described.table
        wanted = [c.column for k in ("time", "valid") for c in d.columns.get(k, ())]
        parts = list(read_batches(table, wanted))
        data = {c: np.concatenate([p[c] for p in parts]) for c in wanted}
        column = d.columns["time"][0].column
        clock = read_clock(seconds(d, data, path), measured_rows(d, data, table), column, table)
        check_excitation(d, clock.time, column, table)
        return clock

    @property
    def duration(self) -> float:
        """Return the time from the first row to the last [s]."""
        return float(self.clock.logged[-1])

    @property
    def period(self) -> float:
        """Return the period of its rows [s]."""
        return float(self.clock.time[1])

    def stretches(self, length: float, lead: float = 0.0) -> Iterator[Stretch]:
        """Yield the whole log in pieces.

        Args:
            length: of a piece [s]; the last may be half as long again.
            lead: what comes before it [s], for whatever has to settle.
        """
        count = max(1, round(self.duration / length))
        edges = np.linspace(0.0, self.duration, count + 1)[:-1]
        starts = [self._tick_near(x) for x in edges]
        ends = [*starts[1:], len(self.clock.kept)]
        begins = [self._tick_near(max(0.0, float(self.clock.logged[s]) - lead)) for s in starts]
        return self.pieces(list(zip(begins, starts, ends, strict=True)))

    def windows(self, starts: Sequence[float], length: float) -> Iterator[Stretch]:
        """Yield only these pieces, which start at the times `starts` [s], in order."""
        first = [self._tick_near(x) for x in starts]
        last = [int(np.searchsorted(self.clock.logged, self.clock.logged[s] + length)) for s in first]
        return self.pieces([(a, a, b) for a, b in zip(first, last, strict=True) if b - a > 1])

    def pieces(self, bounds: Sequence[tuple[int, int, int]]) -> Iterator[Stretch]:
        """Yield rows from first to before last of each triple; what counts begins at the middle.

        The rows are those of `clock`; triples ascend, and may overlap. The table is read through once.
        """
        kept, held, base, todo = self.clock.kept, [], 0, list(bounds)
        rows = 0
        for batch in read_batches(self.described.table, self.described.columns):
            held.append(batch)
            rows += len(next(iter(batch.values())))
            while todo and (todo[0][2] >= len(kept) or kept[todo[0][2]] <= rows):
                first, counts, last = todo[0]
                end = int(kept[last]) if last < len(kept) else self.rows
                if end > rows:
                    break
                start = int(kept[first])
                data = _joined(held, start - base, end - base)
                todo.pop(0)
                yield self._stretch(data, start, int(kept[counts]) - start, float(self.clock.logged[first]))
            keep = int(kept[todo[0][0]]) if todo else rows
            while held and base + (size := len(next(iter(held[0].values())))) <= keep:
                held.pop(0)
                base += size
            if not todo:
                return

    def _stretch(self, data: dict[str, np.ndarray], row: int, lead: int, start: float) -> Stretch:
        try:
            made = assemble(self.described, data, part=True)
        except InputError as error:
            if error.row is None:
                raise
            raise InputError(
                error.problem, file=error.file, column=error.column, row=error.row + row, remedy=error.remedy
            ) from error
        if row > 0:  # wherever the machine was by then, and however fast
            made = replace(made, timing=replace(made.timing, initial_at_rest=False))
        return Stretch(made, start, min(lead, len(made) - 1))

    def _tick_near(self, time: float) -> int:
        """Return the row at or after a time at which the loop ticks, given that it ticks at the first row."""
        logged, period = self.clock.logged, self.described.controller.period_s
        first = int(np.searchsorted(logged, time - 1e-9))
        if period is None:
            return first
        rows = np.arange(first, min(first + max(_MATCHING, int(2 * period / self.period)), len(logged)))
        if not len(rows):
            return first
        off = np.abs(logged[rows] / period - np.round(logged[rows] / period))
        return int(rows[np.flatnonzero(off <= off.min() + 1e-6)[0]])


def open_recordings(
    paths: str | Path | Iterable[str | Path], *, whole: bool = False
) -> list[Recording | Log]:
    """Return recordings, as a `Log` if one is too long for the memory.

    Args:
        paths: as of `load_recordings`.
        whole: hold all of them, however long.

    Raises:
        InputError: as `load_recordings`; of a log, what its TOML file says.
    """
    return [load_recording(f) if whole else open_recording(f) for f in recording_files(paths)]


def open_recording(path: str | Path) -> Recording | Log:
    """Return a recording, or a log if it is larger than `HELD` or `HELD_COUPLED`."""
    described = describe(Path(path))
    table, ending = described.table, described.table.name.lower()
    small = SMALL_TEXT if ending.endswith(".csv") else SMALL
    if ending.endswith(STREAMED) and table.is_file() and table.stat().st_size > small:
        rows, axes = count_rows(table), len(described.contents.axes)
        if rows * axes > HELD or rows * axes**2 > HELD_COUPLED:
            return Log(described, rows)
    return load_recording(path)


def check_moves(log: Log, limits: Mapping[str, np.ndarray]) -> None:
    """Refuse a log in which a signal of a driven axis never changes, as for recordings.

    `limits`: lowest and highest value of each signal in all of it, (2, n).

    Raises:
        InputError: there is one.
    """
    check_alive(log.described.contents, limits, log.described.table)


def _joined(held: Sequence[dict[str, np.ndarray]], start: int, end: int) -> dict[str, np.ndarray]:
    """Return the rows of consecutive pieces, joined."""
    out = {column: [] for column in held[0]}
    at = 0
    for piece in held:
        size = len(next(iter(piece.values())))
        low, high = max(start - at, 0), min(end - at, size)
        if low < high:
            for column, values in piece.items():
                out[column].append(values[low:high])
        at += size
    return {column: np.concatenate(parts) for column, parts in out.items()}
