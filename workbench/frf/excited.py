"""Which lines of a recording were excited, and which experiments belong to one realisation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from workbench.core import InputError, Recording

from .levels import excited_levels
from .records import Choice
from .span import Span
from .spectra import period_spectra

_LOOKED_AT = 12  # last periods among which an input without a reference is searched for what repeats
_SILENT = 1e-4  # a reference's line below this part of the largest was not put there on purpose,
_QUIETER = 0.03  # nor one below this part of the largest nearby: rounding and resampling put something on all
_NEARBY = 8  # lines
_SAME = 0.98  # agreement of spectra that share their phases, noise in a measured input allowed for


def excited_lines(span: Span, lines: Sequence[int] | None) -> np.ndarray:
    """Return the excited harmonics of one experiment, ascending, shape (F,).

    Those given, or named in the recording; else those of the noise-free reference; else those at which the
    command, or the input where no command was logged, repeats and is no mere distortion. The last two within
    the band and the grid that the recording states.

    Args:
        span: the experiment.
        lines: the lines, if they are known.

    Raises:
        InputError: a line that does not exist, or none that was excited.
    """
    recording, choice, rows = span.recording, span.choice, span.rows
    highest = (rows - 1) // 2
    stated = recording.excitation.lines
    named = stated if isinstance(stated, tuple) else None
    if lines is not None or named is not None:
        wanted = np.unique(np.asarray(named if lines is None else lines, int))
        if len(wanted) == 0 or wanted[0] < 1 or wanted[-1] > highest:
            raise InputError(
                f"lines must lie between 1 and {highest}, half the rate", file=recording.source,
                column="excitation.lines" if lines is None else "lines",
                remedy="give harmonics of the period, below half of its rows",
            )  # fmt: skip
        return wanted
    every = np.arange(1, highest + 1)
    signal = choice.reference or _commanded(recording, choice)
    if choice.reference is not None:
        reference = span.columns([choice.reference], periods=1)
        size = np.abs(period_spectra(reference, rows, every)[0]).max(axis=1)
        nearby = scipy.ndimage.maximum_filter1d(size, 2 * _NEARBY + 1)
        found = every[(size > _SILENT * size.max()) & (size > _QUIETER * nearby)]
    else:
        spectra = period_spectra(span.columns([signal], periods=_LOOKED_AT), rows, every)
        size = np.abs(spectra.mean(axis=0)).max(axis=1)
        # what the recording rules out is not what the rest is compared with
        in_band = _in_band(every, recording, rows)
        found = every[in_band][excited_levels(spectra[:, in_band], every[in_band])]
    found = found[_in_band(found, recording, rows)]
    grid = _on_grid(found, size[found - 1], stated if isinstance(stated, str) else None)
    if not grid.any():
        where = f" on the lines that it states ({stated})" if len(found) else ""
        raise InputError(
            f"no line of {signal} stands out in {recording.name}{where}", file=recording.source,
            column="excitation.lines" if where else "excitation",
            remedy="check its period and band, or name the lines (lines = [3, 7, 11])",
        )  # fmt: skip
    return found[grid]


def _commanded(recording: Recording, choice: Choice) -> str:
    """Return ``torque_command`` if the input was measured and a command moves; else the input."""
    command = recording.get("torque_command")
    measured = choice.input not in ("position_reference", "velocity_reference", "torque_feedforward")
    if not measured or command is None or not np.isfinite(command).all():
        return choice.input
    return "torque_command" if np.ptp(command[:, choice.place], axis=0).max() > 0 else choice.input


def common_lines(found: Sequence[np.ndarray], recordings: Sequence[Recording]) -> np.ndarray:
    """Return the lines excited in every experiment.

    Raises:
        InputError: there are none.
    """
    lines = found[0]
    for other in found[1:]:
        lines = np.intersect1d(lines, other)
    if len(lines) == 0:
        remedy = "give experiments that excite the same lines"
        raise InputError("the experiments have no line in common", file=recordings[0].source, remedy=remedy)
    return lines


def realisations(drive: np.ndarray, inputs: int) -> list[list[int]]:
    """Return experiments in complete sets that separate the inputs, one set per realisation of phases.

    Experiments of one set share their phases: on some axis their spectra are equal up to one factor. Where
    that does not say it (one axis driven at a time) they are taken in the order given. Sets that play the
    same again are one realisation: they average noise, and show no distortion.

    Args:
        drive: spectra of what drove the experiments at the excited lines, (E, F, n): the reference, else the
            inputs.
        inputs: number nu of inputs.

    Returns:
        Sets of nu experiments or a multiple of it; a single one of all where E is no multiple of nu.
    """
    experiments = len(drive)
    if experiments % inputs or experiments == inputs:
        return [list(range(experiments))]
    sets, left = [], list(range(experiments))
    alike = _alike(drive).max(axis=2) > _SAME
    while left:
        mine = [e for e in left if alike[left[0], e]]
        sets.append(mine)
        left = [e for e in left if e not in mine]
    if all(_whole(drive[s], inputs) for s in sets):
        return sets
    in_order = [list(range(k, k + inputs)) for k in range(0, experiments, inputs)]
    merged: list[list[int]] = []
    for s in in_order:
        twin = next((m for m in merged if _same(drive[m[:inputs]], drive[s])), None)
        if twin is None:
            merged.append(s)
        else:
            twin.extend(s)
    return merged


def _alike(drive: np.ndarray) -> np.ndarray:
    """Return how well spectra (E, F, n) of two experiments agree up to a factor, (E, E, n); 0 to 1."""
    size = np.linalg.norm(drive, axis=1)
    product = np.abs(np.einsum("efi,gfi->egi", drive.conj(), drive))
    both = size[:, None] * size[None]
    return np.where(both > 0, product / np.where(both > 0, both, 1.0), 0.0)


def _whole(drive: np.ndarray, inputs: int) -> bool:
    """Return whether experiments (E, F, n) separate all inputs at every line."""
    if len(drive) % inputs:
        return False
    values = np.linalg.svd(np.moveaxis(drive, 0, 1), compute_uv=False)
    return bool((values[:, inputs - 1] > 1e-3 * values[:, 0]).all())


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    """Return whether two sets (nu, F, n) play the same."""
    product = np.abs(np.sum(a.conj() * b, axis=(1, 2)))
    return bool((product > _SAME * np.linalg.norm(a, axis=(1, 2)) * np.linalg.norm(b, axis=(1, 2))).all())


def _in_band(lines: np.ndarray, recording: Recording, rows: int) -> np.ndarray:
    """Return which lines lie in the band that the recording states, (F,) bool."""
    e = recording.excitation
    frequency = lines / (rows * recording.period)
    half = 0.5 / (rows * recording.period)
    keep = np.ones(len(lines), bool)
    if e.f_min_hz is not None:
        keep &= frequency > e.f_min_hz - half
    if e.f_max_hz is not None:
        keep &= frequency < e.f_max_hz + half
    return keep


def _on_grid(lines: np.ndarray, size: np.ndarray, stated: str | None) -> np.ndarray:
    """Return which lines (F,) with these amplitudes (F,) are on the recording's grid, (F,) bool."""
    if stated in ("odd", "odd_random"):
        return lines % 2 == 1
    if stated is None or not stated.startswith("every_"):
        return np.ones(len(lines), bool)
    # lines that far apart may begin anywhere: where most of the input is
    apart = int(stated.removeprefix("every_"))
    first, place = np.unique(lines % apart, return_inverse=True)
    return lines % apart == first[np.argmax(np.bincount(place, size**2))] if len(lines) else lines > 0
