"""Reading a recording: TOML and table in, one checked `Recording` in SI units on a uniform clock out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.core import Controller, Excitation, InputError, Recording, Timing
from workbench.core.files import as_path

from .checks import check_alive, check_excitation, check_finite
from .clock import Clock, read_clock
from .convert import axis_signals, axis_units, extra_signals, seconds
from .dead import dead_note, dead_rows
from .description import Description, read_description
from .jitter import settle_jitter
from .quantisation import quantisation_step
from .resample import loop_keeps_time, measured_on_clock, onto_clock
from .stated_loop import stated_loop
from .tables import READERS, read_table
from .tables.can_table import dbc_of, read_can
from .velocity import derive_velocity
from .wrap import unwrap


def load_recording(path: str | Path | Recording) -> Recording:
    """Return the recording that a TOML file describes, checked and in SI units.

    Args:
        path: its TOML file; a recording is returned as it is.

    Returns:
        The recording: SI, uniform clock from 0, gaps filled and masked, rows masked in which drives are off,
        positions of encoders that wrap made whole, velocity derived where it was not measured;
        `Recording.notes` says what was done to the data.

    Raises:
        InputError: anything wrong with either file; the text names file, column, row and remedy.
    """
    if isinstance(path, Recording):
        return path
    described = describe(as_path(path, "a recording"))
    return assemble(described, read_table(described.table, described.columns))


@dataclass(frozen=True)
class Described:
    """The checked content of a recording's TOML file: SI units of its axes, and its loop."""

    contents: Description
    path: Path
    units: tuple[str, ...]
    controller: Controller

    @property
    def table(self) -> Path:
        """Return the table's file."""
        return self.path.parent / self.contents.table

    @property
    def columns(self) -> list[str]:
        """Return the named columns of the table."""
        return [c.column for columns in self.contents.columns.values() for c in columns]


def describe(path: Path) -> Described:
    """Read and check a recording's TOML file.

    Raises:
        InputError: as `load_recording`, of this file.
    """
    d = read_description(path)
    return Described(d, path, axis_units(d, path), stated_loop(d, path))


def assemble(described: Described, data: dict[str, np.ndarray], *, part: bool = False) -> Recording:
    """Return a recording from a table's columns.

    Args:
        described: what they are.
        data: every named column, (N,), in the table's own units.
        part: whether it is a piece of a longer table, in which an axis may rest.

    Raises:
        InputError: as `load_recording`, of the table.
    """
    d, path, table = described.contents, described.path, described.table
    units, controller = described.units, described.controller
    column = d.columns["time"][0].column
    measured = measured_rows(d, data, table)
    clock = read_clock(seconds(d, data, path), measured, column, table)
    good = np.ones(len(data[column]), bool) if measured is None else measured
    signals, extra = axis_signals(d, data, path), extra_signals(d, data, path)
    check_finite(d, {**signals, **extra}, good, table)
    turning, referred = (
        [unit == "rad" for unit in units],
        d.controller is None or controller.coordinates == d.coordinates,
    )
    signals, wrapped = unwrap(signals, good, d.axes, turning, referred=referred)
    loop_s = controller.period_s
    even = clock.row is None and loop_keeps_time(signals, good, clock, loop_s)
    if clock.row is None and not even:
        smooth = [signals[name][clock.kept] for name in ("position", "velocity") if name in signals]
        clock = settle_jitter(clock, smooth)
    steps = _steps(signals, good) if clock.row is None else {}
    moved = {name: onto_clock(name, rows, good, clock, loop_s) for name, rows in signals.items()}
    signals = {name: rows for name, (rows, _) in moved.items()}
    guessed = {name: rows for name, (_, rows) in moved.items() if rows is not None and rows.any()}
    extra = {name: onto_clock(name, rows, good, clock, loop_s)[0] for name, rows in extra.items()}
    if not part:
        check_excitation(d, clock.time, column, table)
        check_alive(d, signals, table)

    valid = measured_on_clock(good, clock)
    notes = (*wrapped, *_clock_notes(clock, valid))
    derived: tuple[str, ...] = ()
    if "velocity" not in signals:
        signals["velocity"] = derive_velocity(signals["position"], float(clock.time[1]))
        derived = ("velocity",)
        notes += ("Velocity was not measured; it is derived from position by a zero-phase filter.",)
    dead = dead_rows(signals, valid, float(clock.time[1]), controller, d.coordinates)
    if dead.any():
        valid = valid & ~dead.any(axis=1)
        notes += (dead_note(dead, d.axes, float(clock.time[1])),)
    return Recording(
        name=d.name or path.stem,
        axes=tuple(d.axes),
        coordinates=d.coordinates,
        time=clock.time,
        signals=signals,
        units=units,
        controller=controller,
        excitation=Excitation(**d.excitation.model_dump()),
        timing=Timing(**d.timing.model_dump()),
        rig=d.rig,
        valid=valid,
        derived=derived,
        notes=notes,
        extra=extra,
        source=path,
        steps=steps,
        late_s=0.0 if even else clock.late_s,
        guessed=guessed,
        guessed_units=tuple(d.guessed_units),
    )


def _steps(signals: Mapping[str, np.ndarray], good: np.ndarray) -> dict[str, np.ndarray]:
    """Return the resolution (n,) of sensors, 0 where a signal has none or never changes."""
    return {
        name: np.array([quantisation_step(x) for x in signals[name][good].T])
        for name in ("position", "velocity", "torque_measured")
        if name in signals
    }


def measured_rows(d: Description, data: dict[str, np.ndarray], table: Path) -> np.ndarray | None:
    """Return which rows were measured, shape (N,) bool; None if the table does not say."""
    if "valid" not in d.columns:
        return None
    column = d.columns["valid"][0].column
    flags = data[column]
    bad = ~np.isin(flags, (0.0, 1.0))
    if bad.any():
        row = int(np.argmax(bad))
        remedy = "write 1 for a measured row and 0 for a masked one"
        raise InputError(f"valid is {flags[row]:g}", file=table, column=column, row=row + 1, remedy=remedy)
    if flags.sum() < 2:
        remedy = "record again, or correct the `valid` column"
        raise InputError("fewer than two rows are valid", file=table, column=column, remedy=remedy)
    return flags == 1.0


def _clock_notes(clock: Clock, valid: np.ndarray) -> tuple[str, ...]:
    notes: tuple[str, ...] = ()
    if clock.jitter:
        period = f"{1e3 * clock.time[1]:.6g} ms"
        done = (
            f"resampled onto a period of {period}"
            if clock.row is None
            else f"is only in the time stamps: the rows are {period} apart"
        )
        notes += (f"Clock jitter of {100 * clock.jitter:.2g} % (rms) {done}.",)
    masked = int((~valid).sum())
    if masked:
        notes += (f"{masked} of {len(valid)} rows are masked and were filled by interpolation.",)
    return notes


def source_files(path: str | Path) -> list[Path]:
    """Return a recording's TOML file, its table, and the DBC file if the table is a log of a bus.

    Raises:
        InputError: the TOML file cannot be read.
    """
    file = Path(path)
    table = file.parent / read_description(file).table
    log = READERS.get(table.suffix.lower()) is read_can
    dbc = dbc_of(table) if log else None
    return [file, table, *([dbc] if dbc else [])]
