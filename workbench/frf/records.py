"""Recordings as columns for estimation: which signals, which rows, and what makes them unusable."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import AXIS_SIGNALS, InputError, Recording
from workbench.recordings.resample import looks_held

from .channel import Channel
from .period import find_period

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

    def columns(
        self, recording: Recording, rows: slice = slice(None), signals: Sequence[str] | None = None
    ) -> np.ndarray:
        """Return outputs, inputs, references (or some `signals`) side by side, (rows, ny + nu + nr)."""
        names = self.signals if signals is None else signals
        return np.concatenate([recording.signals[s][rows, self.place] for s in names], axis=1)

    @property
    def signals(self) -> tuple[str, ...]:
        """Return the names of outputs, input and reference, in the order of `columns`."""
        return (*self.outputs, self.input, *((self.reference,) if self.reference else ()))

    @property
    def place(self) -> slice | list[int]:
        """Return the axes as a slice if they are neighbours (which needs no copy), else as a list."""
        first, last = self.axes[0], self.axes[-1]
        side_by_side = self.axes == tuple(range(first, last + 1))
        return slice(first, last + 1) if side_by_side else list(self.axes)

    def channels(self, recording: Recording) -> tuple[tuple[Channel, ...], tuple[Channel, ...]]:
        """Return the outputs and the inputs of the response, as its rows and columns."""

        def of(signal: str) -> list[Channel]:
            kind = AXIS_SIGNALS[signal]
            fixed = {"current": "A", "voltage": "V", "temperature": "K"}
            return [
                Channel(signal, recording.axes[a], fixed.get(kind) or _UNITS[recording.units[a]][kind])
                for a in self.axes
            ]

        return tuple(c for s in self.outputs for c in of(s)), tuple(of(self.input))

    def hold(self, recordings: Sequence[Recording]) -> float | None:
        """Return how long the input stays constant after each row [s]; None if it is smooth between rows."""
        first = recordings[0]
        held = self.input == "torque_command" or looks_held(first.signals[self.input])
        return first.period if held and not self.faster_than_log(recordings) else None

    def faster_than_log(self, recordings: Sequence[Recording]) -> bool:
        """Return whether a commanded input changes between rows, where the log does not show it."""
        ticks = [r.controller.period_s or r.period for r in recordings]
        return self.input == "torque_command" and min(ticks) < 0.999 * recordings[0].period


def choose(
    recordings: Sequence[Recording],
    *,
    input: str | None,
    output: str | Sequence[str] | None,
    reference: str | None,
    axes: Sequence[str] | None,
) -> Choice:
    """Return which signals to use, after checking that the recordings belong together.

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
            _check_there(r, signal)
    found = _reference(recordings, places, input) if reference == "auto" else reference
    return Choice(input, outputs, found, places)


def rows_of_period(recordings: Sequence[Recording], choice: Choice, period_s: float | None) -> float:
    """Return the number of rows per period, not always a whole number.

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
    found = find_period(first.signals[signal][:, choice.place])
    if found is None:
        raise InputError(
            f"no period shows in {signal}", file=first.source, column="excitation.period_s",
            remedy="state it there, or record an excitation that repeats: workbench excite",
        )  # fmt: skip
    return found


def check_rows(recording: Recording, choice: Choice, first: int, last: int) -> None:
    """Raise InputError at the first masked row, or number that is not finite, in rows first to last - 1."""
    masked = ~recording.valid[first:last]
    if masked.any():
        raise InputError(
            f"{int(masked.sum())} rows are masked in the periods of {recording.name}", file=recording.source,
            row=first + int(np.argmax(masked)) + 1,
            remedy="cut the recording there; a frequency response needs whole periods without gaps",
        )  # fmt: skip
    for signal in choice.signals:
        values = recording.signals[signal][first:last, choice.place]
        # a sum is finite where all are, and takes no memory
        if not np.isfinite(values.sum()):
            row, column = np.argwhere(~np.isfinite(values))[0]
            raise InputError(
                f"{signal} of axis '{recording.axes[choice.axes[column]]}' is not a number",
                file=recording.source, column=signal, row=first + int(row) + 1,
                remedy="cut the recording there",
            )  # fmt: skip


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


def _check_there(recording: Recording, signal: str) -> None:
    if signal not in AXIS_SIGNALS:
        remedy = f"choose from {', '.join(AXIS_SIGNALS)}"
        raise InputError(f"'{signal}' is not a signal of recordings", column=signal, remedy=remedy)
    values = recording.get(signal)
    if values is None:
        have = ", ".join(recording.signals)
        raise InputError(
            f"{recording.name} has no {signal}", file=recording.source, column=f"columns.{signal}",
            remedy=f"name its column, or choose from {have}",
        )  # fmt: skip
    if values.shape != (len(recording), len(recording.axes)):
        problem = f"{signal} has shape {values.shape} for {len(recording)} rows"
        raise InputError(problem, file=recording.source, column=signal, remedy="give one column per axis")


def _reference(recordings: Sequence[Recording], axes: Sequence[int], input: str) -> str | None:
    """Return the first noise-free signal that moves in every recording; None if there is none."""
    for signal in _REFERENCES:
        values = [r.get(signal) for r in recordings]
        if signal != input and all(v is not None and np.ptp(v[:, list(axes)]) > 0 for v in values):
            return signal
    return None
