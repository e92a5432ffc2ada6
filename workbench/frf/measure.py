"""From periodic recordings to spectra: rows, lines, transients; nothing is estimated yet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import InputError, Recording
from workbench.core.text import counted

from .excited import common_lines, excited_lines
from .lines import detection_lines
from .records import Choice, choose, rows_of_period
from .span import whole_periods
from .spectra import Spectra, reduce


@dataclass(frozen=True, eq=False)
class Measured:
    """Spectra of a group of experiments, before any response is estimated from them.

    Attributes:
        recordings: the experiments.
        choice: their signals.
        lines: excited harmonics, (F,).
        listening: odd and even detection harmonics.
        frequency: of all lines together [Hz], ascending order of `every`.
        every: excited and detection harmonics, ascending, (L,).
        spectra: one entry per experiment, at `every`.
        posture: mean measured position of every axis over the rows used.
        notes: what was done to the data.
    """

    recordings: tuple[Recording, ...]
    choice: Choice
    lines: np.ndarray
    listening: tuple[np.ndarray, np.ndarray]
    frequency: np.ndarray
    every: np.ndarray
    spectra: tuple[Spectra, ...]
    posture: np.ndarray
    notes: tuple[str, ...]

    def at(self, lines: np.ndarray) -> np.ndarray:
        """Return the indices of harmonics in `every`."""
        return np.searchsorted(self.every, lines)


def lines_of(recording: Recording) -> np.ndarray:
    """Return the harmonics excited in one recording of a periodic excitation, (F,), ascending.

    Raises:
        InputError: no torque, whole periods or lines; see `workbench.frf.estimate`.
    """
    choice = choose([recording], input=None, output=None, reference="auto", axes=None)
    return excited_lines(whole_periods(recording, choice, rows_of_period([recording], choice, None)), None)


def measure(
    recordings: Sequence[Recording],
    *,
    input: str | None = None,
    output: str | Sequence[str] | None = None,
    reference: str | None = "auto",
    axes: Sequence[str] | None = None,
    period_s: float | None = None,
    lines: Sequence[int] | None = None,
    transient_periods: int | None = None,
    leakage: bool = True,
) -> Measured:
    """Return spectra of periodic experiments; arguments and errors as `workbench.frf.estimate`."""
    choice = choose(recordings, input=input, output=output, reference=reference, axes=axes)
    period = rows_of_period(recordings, choice, period_s)
    notes: list[str] = []
    spans = [whole_periods(r, choice, period) for r in recordings]
    rows = spans[0].rows
    excited = common_lines([excited_lines(span, lines) for span in spans], recordings)
    odd, even = detection_lines(excited)
    every = np.union1d(excited, np.concatenate([odd, even]))
    every = every[every <= (rows - 1) // 2]
    if not spans[0].whole:
        notes.append(f"A period is {period:.6g} rows: the signals were interpolated to {rows}.")
    spectra, postures = [], []
    for span in spans:  # one experiment's signals are in memory at a time
        if transient_periods is not None and not 0 <= transient_periods <= span.count - 2:
            raise InputError(
                f"{transient_periods} transient periods leave fewer than two of {span.count}",
                file=span.recording.source, column="transient_periods", remedy="drop fewer, or record more",
            )  # fmt: skip
        s = reduce(span.columns(), rows, every, np.isin(every, excited), transient_periods, leakage)
        spectra.append(s)
        used = span.recording.position[span.last - round(s.periods * period) : span.last]
        postures.append(used.mean(axis=0))
        notes += _transient_note(span.recording.name, s)
    return Measured(
        tuple(recordings),
        choice,
        excited,
        (odd[np.isin(odd, every)], even[np.isin(even, every)]),
        every / (period * recordings[0].period),
        every,
        tuple(spectra),
        np.mean(postures, axis=0),
        tuple(notes),
    )


def _transient_note(name: str, s: Spectra) -> list[str]:
    if s.settled is None:
        before = f" after {counted(s.dropped, 'transient one')}" if s.dropped else ""
        return [f"{name}: {s.periods} periods{before} are too few to tell whether the transient had died."]
    if not s.settled:
        return [f"{name}: the response does not settle; {s.dropped} leading periods were dropped."]
    return [f"{name}: left out {counted(s.dropped, 'transient period')}."] if s.dropped else []
