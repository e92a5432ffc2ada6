"""Signals of a result per recording, for other programs: measured, simulated, and the difference."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from workbench.core import Recording, Result
from workbench.core.recording import AXIS_SIGNALS
from workbench.core.units import KINDS

from .pack import comparisons, partner
from .residuals import SIGNALS, has

#: Name of a signal -> (N, n).
Signals = Mapping[str, np.ndarray]


def series_of(result: Result) -> Iterator[tuple[str, str, Recording, Signals]]:
    """Return a recording's name, kinds of its signals, recordings with times and rows, and the signals.

    What they are: ``measured``, ``simulated`` and ``residual`` (measured minus simulated), and where effects
    were found ``simulated_with_effects`` and ``residual_with_effects``. Names that occur again get a number.
    """
    before, after = comparisons(result)
    names: list[str] = []
    for i, entry in enumerate(before.recordings if before else ()):
        name = entry.recording.name
        names.append(name)
        named = name if names.count(name) == 1 else f"{name}_{names.count(name)}"
        yield named, "measured", entry.recording, entry.recording.signals
        later = partner(after, before, i) if before else None
        for run, end in ((entry, ""), (later, "_with_effects")):
            if run is not None:
                yield named, f"simulated{end}", run.recording, run.simulated.signals
                residual = {name: run.residual(name) for name, _ in SIGNALS if has(run, name)}
                yield named, f"residual{end}", run.recording, residual


def si_units(recording: Recording, signal: str) -> tuple[str, ...]:
    """Return the SI unit of a signal on each axis."""
    choices = KINDS[AXIS_SIGNALS[signal]]
    return tuple(choices[0 if unit == "rad" else -1] for unit in recording.units)
