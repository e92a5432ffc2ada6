"""From table columns to SI: first scale and offset in the stated unit, then the unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from workbench.core import AXIS_SIGNALS, InputError
from workbench.core.units import KINDS, to_si

from .description import Column, Description

_LINEAR = {"position": "m", "velocity": "m/s", "torque": "N"}


def axis_signals(d: Description, data: dict[str, np.ndarray], path: Path) -> dict[str, np.ndarray]:
    """Return every axis signal of the description in SI, each (N, n)."""
    return {
        signal: np.column_stack(
            [
                _si(data, column, unit, kind, path)
                for column, unit in zip(d.columns[signal], _units(d, kind), strict=True)
            ]
        )
        for signal, kind in AXIS_SIGNALS.items()
        if signal in d.columns
    }


def extra_signals(d: Description, data: dict[str, np.ndarray], path: Path) -> dict[str, np.ndarray]:
    """Return columns kept beside the axis signals, each (N, k); ``base_*`` must be in SI already."""
    kinds = {"ground_force": "force"}
    return {
        signal: np.column_stack(
            [_si(data, c, d.units.get("force", ["N"])[0], kinds.get(signal), path) for c in columns]
        )
        for signal, columns in d.columns.items()
        if signal not in AXIS_SIGNALS and signal not in ("time", "valid")
    }


def seconds(d: Description, data: dict[str, np.ndarray], path: Path) -> np.ndarray:
    """Return the time column [s], shape (N,)."""
    return _si(data, d.columns["time"][0], d.units.get("time", ["s"])[0], "time", path)


def axis_units(d: Description, path: Path) -> tuple[str, ...]:
    """Return ``"rad"`` or ``"m"`` for each axis.

    Raises:
        InputError: a velocity or torque unit that does not fit its axis' position unit.
    """
    si = {kind: [_conversion(u, kind, path)[2] for u in _units(d, kind)] for kind in _LINEAR}
    for i, axis in enumerate(d.axes):
        linear = si["position"][i] == "m"
        for kind in ("velocity", "torque"):
            if (si[kind][i] == _LINEAR[kind]) != linear:
                wanted = _LINEAR[kind] if linear else KINDS[kind][0]
                moves = "moves along a line" if linear else "turns"
                raise InputError(
                    f"axis '{axis}' {moves} but its {kind} is in {si[kind][i]}", file=path,
                    column=f"units.{kind}", remedy=f"give a unit like {wanted}",
                )  # fmt: skip
    return tuple(si["position"])


def _units(d: Description, kind: str) -> list[str]:
    """Return the unit of each axis; SI if none is stated, linear if the position is."""
    stated = d.units.get(kind)
    if stated is not None:
        return stated * len(d.axes) if len(stated) == 1 else stated
    rotary = KINDS[kind][0]
    if kind in ("velocity", "torque") and "position" in d.units:
        return [_LINEAR[kind] if _is_length(u) else rotary for u in _units(d, "position")]
    return [rotary] * len(d.axes)


def _is_length(unit: str) -> bool:
    try:
        return to_si(unit, "position")[2] == "m"
    except ValueError:
        return False  # said clearly where the position itself is converted


def _conversion(unit: str, kind: str, path: Path) -> tuple[float, float, str]:
    try:
        return to_si(unit, kind)
    except ValueError as error:
        remedy = f"write a unit like {' or '.join(KINDS[kind])}"
        raise InputError(str(error), file=path, column=f"units.{kind}", remedy=remedy) from error


def _si(data: dict[str, np.ndarray], column: Column, unit: str, kind: str | None, path: Path) -> np.ndarray:
    values = data[column.column]
    if (column.scale, column.offset) != (1.0, 0.0):
        values = values * column.scale + column.offset
    if kind is None:
        return values
    scale, offset, _ = _conversion(unit, kind, path)
    return values if (scale, offset) == (1.0, 0.0) else values * scale + offset
