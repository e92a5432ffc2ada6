"""Recordings as columns for estimation: which signals, which rows, and what makes them unusable."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

from workbench.core import AXIS_SIGNALS, InputError, Recording
from workbench.recordings.resample import looks_held

from .period import find_period, periodic_rows
from .response import Channel

_UNITS = {
    "rad": {"position": "rad", "velocity": "rad/s", "torque": "N m"},
    "m": {"position": "m", "velocity": "m/s", "torque": "N"},
}
_REFERENCES = ("torque_feedforward", "position_reference", "velocity_reference")


@dataclass(frozen=True)
class Choice:
    """Which signals of the recordings are input, outputs and (noise-free) reference, and which axes."""

    input: str
    outputs: tuple[str, ...]
    reference: str | None
    axes: tuple[int, ...]

    def columns(self, recording: Recording) -> np.ndarray:
        """Outputs, inputs, references side by side, (N, ny + nu + nr)."""
        names = (*self.outputs, self.input, *((self.reference,) if self.reference else ()))
        return np.concatenate([recording.signals[s][:, list(self.axes)] for s in names], axis=1)

    def channels(self, recording: Recording) -> tuple[tuple[Channel, ...], tuple[Channel, ...]]:
        """What the response's rows and columns are."""

        def of(signal: str) -> list[Channel]:
            kind = AXIS_SIGNALS[signal]
            fixed = {"current": "A", "voltage": "V", "temperature": "K"}
            return [
                Channel(signal, recording.axes[a], fixed.get(kind) or _UNITS[recording.units[a]][kind])
                for a in self.axes
            ]

        return tuple(c for s in self.outputs for c in of(s)), tuple(of(self.input))

    def hold(self, recordings: Sequence[Recording]) -> float | None:
        """How long the input stands still from each row on [s]; None where it is smooth between rows."""
        held = self.input == "torque_command" or looks_held(recordings[0].signals[self.input])
        return recordings[0].period if held else None


def choose(
    recordings: Sequence[Recording],
    *,
    input: str | None,
    output: str | Sequence[str] | None,
    reference: str | None,
    axes: Sequence[str] | None,
) -> Choice:
    """Check that recordings belong together, and settle which signals to use.

    Args:
        recordings: at least one; same axes, coordinates, units and clock.
        input: None takes the torque command (the total torque asked for, before any delay), else the
            measured torque.
        output: None takes the velocity where it was measured, else the position.
        reference: ``"auto"`` takes the first noise-free signal that excites (feedforward, position
            reference, velocity reference); None none.
        axes: names; None all.

    Raises:
        InputError: no recordings, recordings that do not belong together, or a signal that one lacks.
    """
    if not recordings:
        raise InputError("no recordings given", remedy="name at least one recording's TOML file")
    first = recordings[0]
    for r in recordings[1:]:
        _check_alike(first, r)
    unknown = [a for a in axes or () if a not in first.axes]
    if unknown or (axes is not None and not axes):
        problem = f"axis '{unknown[0]}' is not there" if unknown else "no axis is named"
        raise InputError(problem, file=first.source, column="axes", remedy=f"choose from {first.axes}")
    places = tuple(first.axes.index(a) for a in axes) if axes else tuple(range(len(first.axes)))
    if input is None:
        both = ("torque_command", "torque_measured")
        input = next((s for s in both if all(r.get(s) is not None for r in recordings)), both[0])
    if output is None:
        derived = any("velocity" in r.derived or r.get("velocity") is None for r in recordings)
        output = "position" if derived else "velocity"
    outputs = (output,) if isinstance(output, str) else tuple(output)
    for r in recordings:
        for signal in (input, *outputs, *((reference,) if reference not in (None, "auto") else ())):
            _check_there(r, signal, places)
    found = _reference(recordings, places, input) if reference == "auto" else reference
    return Choice(input, outputs, found, places)


def rows_of_period(recordings: Sequence[Recording], choice: Choice, period_s: float | None) -> float:
    """Rows a period, not always a whole number.

    Taken from `period_s`, else from what the recordings say of their excitation, else from the
    autocorrelation of reference or input.

    Raises:
        InputError: a period that is no positive number, or none that shows.
    """
    first = recordings[0]
    stated = {r.excitation.period_s for r in recordings} if period_s is None else {period_s}
    stated.discard(None)
    if len(stated) > 1:
        problem = f"the recordings state different periods: {sorted(x for x in stated if x)} s"
        raise InputError(problem, file=first.source, column="excitation.period_s", remedy="group them")
    if stated:
        value = stated.pop()
        if value is None or not np.isfinite(value) or value <= 0:
            remedy = "give the excitation's period in seconds"
            raise InputError(f"a period of {value} s", file=first.source, column="period_s", remedy=remedy)
        return value / first.period
    signal = choice.reference or choice.input
    found = find_period(first.signals[signal][:, list(choice.axes)])
    if found is None:
        raise InputError(
            f"no period shows in {signal}",
            file=first.source,
            column="excitation.period_s",
            remedy="state it, or use the local polynomial method for a record that does not repeat",
        )
    return found


def whole_periods(
    recording: Recording, choice: Choice, period: float, first_row: int = 0
) -> tuple[np.ndarray, int, int]:
    """The rows of whole periods, the last ones that fit, on a clock that divides the period.

    What is left over lies at the beginning, where the transient is.

    Args:
        recording: one experiment.
        choice: its signals.
        period: in rows.
        first_row: rows before it are not used.

    Returns:
        ``(columns, rows, start)``: outputs, inputs, references (P rows_of_a_period, nz), the rows a period,
        and the recording's row at which they begin.

    Raises:
        InputError: fewer than two whole periods, or a masked or missing number in them.
    """
    columns = choice.columns(recording)
    rows = round(period)
    whole = abs(period - rows) * (len(recording) / period) < 0.02
    first, last = first_row, len(recording)
    if choice.reference is not None and whole:
        begin, end = periodic_rows(recording.signals[choice.reference][:, list(choice.axes)], rows)
        if end > begin:
            first, last = max(begin, first_row), end
    count = int(np.floor((last - first) / (rows if whole else period) * (1 + 1e-9)))
    if rows < 4 or count < 2:
        raise InputError(
            f"{max(count, 0)} whole period(s) of {period * recording.period:.6g} s in {recording.name}",
            file=recording.source,
            remedy="record two or more, or use the local polynomial method",
        )
    if whole:
        start = last - count * rows
        check_rows(recording, choice, start, last)
        return columns[start:last], rows, start
    start = last - round(count * period)
    check_rows(recording, choice, max(start - 1, 0), last)
    # input and output are resampled by the same rule, so that its small errors cancel in the response
    at = np.clip(last - 1 - (period / rows) * np.arange(count * rows)[::-1], 0, last - 1)
    spline = make_interp_spline(np.arange(last), columns[:last], k=5)
    return np.asarray(spline(at)), rows, start


def check_rows(recording: Recording, choice: Choice, first: int, last: int) -> None:
    """Raises InputError at the first masked row, or number that is not finite, in rows first to last - 1."""
    masked = ~recording.valid[first:last]
    if masked.any():
        raise InputError(
            f"{int(masked.sum())} rows are masked in the periods of {recording.name}",
            file=recording.source,
            row=first + int(np.argmax(masked)) + 1,
            remedy="cut the recording there; a frequency response needs whole periods without gaps",
        )
    for signal in (*choice.outputs, choice.input, *((choice.reference,) if choice.reference else ())):
        bad = ~np.isfinite(recording.signals[signal][first:last, list(choice.axes)])
        if bad.any():
            row, column = np.argwhere(bad)[0]
            raise InputError(
                f"{signal} of axis '{recording.axes[choice.axes[column]]}' is not a number",
                file=recording.source,
                column=signal,
                row=first + int(row) + 1,
                remedy="cut the recording there",
            )


def _check_alike(first: Recording, other: Recording) -> None:
    same = {
        "axes": (first.axes, other.axes),
        "coordinates": (first.coordinates, other.coordinates),
        "units": (first.units, other.units),
    }
    for what, (a, b) in same.items():
        if a != b:
            problem = f"{what} {b} where '{first.name}' has {a}"
            raise InputError(problem, file=other.source, column=what, remedy="estimate them apart")
    if abs(other.period - first.period) > 1e-6 * first.period:
        problem = (
            f"rows every {1e3 * other.period:.6g} ms where '{first.name}' has {1e3 * first.period:.6g} ms"
        )
        raise InputError(problem, file=other.source, column="time", remedy="log all at one rate")


def _check_there(recording: Recording, signal: str, axes: Sequence[int]) -> None:
    if signal not in AXIS_SIGNALS:
        remedy = f"choose from {', '.join(AXIS_SIGNALS)}"
        raise InputError(f"'{signal}' is not a signal of recordings", column=signal, remedy=remedy)
    values = recording.get(signal)
    if values is None:
        have = ", ".join(recording.signals)
        raise InputError(
            f"{recording.name} has no {signal}",
            file=recording.source,
            column=f"columns.{signal}",
            remedy=f"name its column, or choose from {have}",
        )
    if values.shape != (len(recording), len(recording.axes)):
        problem = f"{signal} has shape {values.shape} for {len(recording)} rows"
        raise InputError(problem, file=recording.source, column=signal, remedy="give one column per axis")


def _reference(recordings: Sequence[Recording], axes: Sequence[int], input: str) -> str | None:
    """The first noise-free signal that moves in every recording."""
    for signal in _REFERENCES:
        values = [r.get(signal) for r in recordings]
        if signal != input and all(v is not None and np.ptp(v[:, list(axes)]) > 0 for v in values):
            return signal
    return None
