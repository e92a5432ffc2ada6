"""From periodic recordings to spectra: rows, lines, transients; nothing is estimated yet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import InputError, Recording

from .excited import common_lines, excited_lines
from .lines import detection_lines
from .records import Choice, choose, rows_of_period, whole_periods
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
        spectra: one entry an experiment, at `every`.
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
        """Places of harmonics in `every`."""
        return np.searchsorted(self.every, lines)


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
) -> Measured:
    """Spectra of periodic experiments; arguments and errors as `workbench.frf.estimate`."""
    choice = choose(recordings, input=input, output=output, reference=reference, axes=axes)
    period = rows_of_period(recordings, choice, period_s)
    notes: list[str] = []
    blocks, found, postures = [], [], []
    for r in recordings:
        columns, rows, start = whole_periods(r, choice, period)
        blocks.append((columns, rows))
        found.append(excited_lines(r, choice, columns, rows, lines))
        postures.append(r.position[start:].mean(axis=0))
    excited = common_lines(found, recordings)
    odd, even = detection_lines(excited)
    every = np.union1d(excited, np.concatenate([odd, even]))
    every = every[every <= (blocks[0][1] - 1) // 2]
    if abs(period - blocks[0][1]) * len(recordings[0]) / period >= 0.02:
        notes.append(f"A period is {period:.6g} rows: the signals were interpolated to {blocks[0][1]}.")
    spectra = []
    for r, (columns, rows) in zip(recordings, blocks, strict=True):
        if transient_periods is not None and len(columns) // rows - transient_periods < 2:
            raise InputError(
                f"{transient_periods} transient periods leave fewer than two of {len(columns) // rows}",
                file=r.source,
                column="transient_periods",
                remedy="drop fewer, or record more",
            )
        s = reduce(columns, rows, every, np.isin(every, excited), transient_periods)
        spectra.append(s)
        notes += _transient_note(r.name, s)
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
        before = f" after {s.dropped} transient one(s)" if s.dropped else ""
        return [f"{name}: {s.periods} periods{before} are too few to tell whether the transient had died."]
    if not s.settled:
        return [f"{name}: the response does not settle; {s.dropped} leading periods were dropped."]
    return [f"{name}: {s.dropped} transient period(s) were dropped."] if s.dropped else []
