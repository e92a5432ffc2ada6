"""Checks that a recording is long enough, fast enough, and changes where it was driven."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workbench.core import InputError

from .description import Description

_LARGEST = 1e12  # SI; nothing that moves has more of anything, and the square of it is still a number
_MEASURED = ("position", "velocity", "torque_measured")


def check_finite(d: Description, signals: Mapping[str, np.ndarray], measured: np.ndarray, path: Path) -> None:
    """Raise InputError at the first cell of a measured row that no sensor can have given."""
    for signal, values in signals.items():
        bad = measured[:, None] & ~(np.abs(values) < _LARGEST)
        if bad.any():
            row, column = np.argwhere(bad)[0]
            value = values[row, column]
            found = (
                "empty or NaN" if np.isnan(value) else "infinite" if np.isinf(value) else f"{value:g} in SI"
            )
            raise InputError(
                f"{signal} is {found}", file=path, column=d.columns[signal][column].column, row=int(row) + 1,
                remedy="remove the row, or mark it in a `valid` column to have it filled and masked",
            )  # fmt: skip


def check_excitation(d: Description, time: np.ndarray, column: str, path: Path) -> None:
    """Raise InputError if the recording is shorter or slower than its stated excitation.

    Args:
        d: the recording's description.
        time: uniform clock [s], shape (N,).
        column, path: for error texts.
    """
    period = time[1]
    wanted, f_max = d.excitation.period_s, d.excitation.f_max_hz
    if wanted is not None and len(time) * period < wanted * (1 - 1e-6):
        raise InputError(
            f"{len(time)} rows last {len(time) * period:.4g} s, less than one period of {wanted:g} s",
            file=path, column=column,
            remedy="record at least one whole period, or correct excitation.period_s",
        )  # fmt: skip
    named = "f_max_hz"
    if wanted and isinstance(d.excitation.lines, tuple) and d.excitation.lines[-1] / wanted > (f_max or 0.0):
        named, f_max = "lines", d.excitation.lines[-1] / wanted
    if f_max is not None and 1 / period <= 2 * f_max:
        raise InputError(
            f"the rate of {1 / period:.4g} Hz is too low for an excitation up to {f_max:g} Hz", file=path,
            column=column, remedy=f"log faster than {2 * f_max:g} Hz, or correct excitation.{named}",
        )  # fmt: skip


def check_alive(d: Description, signals: Mapping[str, np.ndarray], path: Path) -> None:
    """Raise InputError if a measured signal of a driven axis never changes. A held axis is fine."""
    if d.excitation.kind == "hold":
        return
    driven = driven_axes(signals)
    if driven is None:
        driven = np.full(len(d.axes), not _changes(signals["position"]).any())
    for signal in _MEASURED:
        if signal in signals:
            dead = driven & ~_changes(signals[signal])
            if dead.any():
                i = int(np.argmax(dead))
                raise InputError(
                    f"{signal} of the excited axis '{d.axes[i]}' never changes", file=path,
                    column=d.columns[signal][i].column,
                    remedy="check the sensor and the column's name, or leave the axis or the signal out",
                )  # fmt: skip


def driven_axes(signals: Mapping[str, np.ndarray]) -> np.ndarray | None:
    """Return which axes were excited, shape (n,) bool; None if the log does not tell.

    Reference and feedforward say it. A command counts too, unless it is only the feedback of a held
    axis answering its sensor's noise: it must be a tenth of the largest, in a run that was driven. Where
    it never changes, beside others that do, the drive was off, whatever its reference was.
    """
    stated = [_changes(signals[s]) for s in _STATED if s in signals]
    command = signals.get("torque_command")
    if command is None:
        return np.any(stated, axis=0) if stated else None
    size = np.std(command, axis=0)
    strong = _changes(command) & (size > 0.1 * size.max())
    if not stated:
        return strong
    on = _changes(command) if _changes(command).any() else np.ones(len(size), dtype=bool)
    return np.any(stated, axis=0) & on | (strong if np.any(stated) else False)


_STATED = ("position_reference", "velocity_reference", "torque_feedforward")


def _changes(values: np.ndarray) -> np.ndarray:
    """Return which columns of (N, n) change by more than the rounding of floats."""
    return np.ptp(values, axis=0) > 1e-9 * (1 + np.abs(values).max(axis=0))
