"""Writing a recording: TOML and table, both or neither, and nothing overwritten unasked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from workbench.core import AXIS_SIGNALS, Controller, InputError, Recording
from workbench.core.files import as_path, check_free, write_all
from workbench.core.units import KINDS

from .tables.csv_table import csv_bytes

#: Column prefix of each signal.
_SHORT = {
    "position": "q",
    "velocity": "w",
    "torque_command": "cmd",
    "torque_measured": "tau",
    "torque_feedforward": "ff",
    "position_reference": "qref",
    "velocity_reference": "wref",
    "link_position": "qlink",
    "current": "i",
    "voltage": "u",
    "temperature": "temp",
}


def save_recording(
    recording: Recording, toml_path: str | Path, *, compress: bool = True, force: bool = False,
    beside: Mapping[Path, bytes] | None = None,
) -> None:  # fmt: skip
    """Write a recording as a table and a TOML file that `load_recording` reads back.

    The table stands beside the TOML under the same name, as ``.csv.gz`` (``.csv`` without `compress`).
    Derived signals are left out, so that they are not taken for measured ones when read.

    Args:
        recording: what to write.
        toml_path: the TOML file, ending in ``.toml``.
        compress: gzip the table.
        force: replace files that are there.
        beside: further files of the same folder that belong to it: all of them are written, or none.

    Raises:
        InputError: a file is there and `force` is not given, or the folder cannot be written.
    """
    if not isinstance(recording, Recording):
        raise InputError(
            f"a recording is expected, not a value of type {type(recording).__name__}",
            remedy="give the recording first, then its TOML file",
        )
    toml_path = as_path(toml_path, "the name of a TOML file", "name the file to write")
    if toml_path.suffix != ".toml":
        raise InputError("does not end in .toml", file=toml_path, remedy="name the recording's TOML file")
    table_path = toml_path.with_suffix(".csv.gz" if compress else ".csv")
    for path in (toml_path, table_path):
        check_free(path, force=force)

    columns, data = _table(recording)
    text = tomli_w.dumps(_description(recording, table_path.name, columns)).encode()
    table = csv_bytes(data, pack=compress)
    write_all({**(beside or {}), table_path: table, toml_path: text}, force=force)


def _table(recording: Recording) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Return the ``[columns]`` table of the TOML, and the columns."""
    columns: dict[str, Any] = {"time": "t"}
    data = {"t": np.round(recording.time, 12)}
    for signal in AXIS_SIGNALS:
        values = recording.get(signal)
        if values is not None and signal not in recording.derived:
            names = [f"{_SHORT[signal]}_{axis}" for axis in recording.axes]
            columns[signal] = names
            data |= dict(zip(names, values.T, strict=True))
    for signal, values in recording.extra.items():
        names = [f"{signal}_{i}" for i in range(values.shape[1])]
        columns[signal] = names
        data |= dict(zip(names, values.T, strict=True))
    if not recording.valid.all():
        columns["valid"] = "valid"
        data["valid"] = recording.valid.astype(int)
    return columns, data


def _description(recording: Recording, table: str, columns: dict[str, Any]) -> dict[str, Any]:
    c = recording.controller
    keys = ("kp", "kd", "kv", "gain", "limit")
    gains = {key: [x for x in getattr(c, key) if math.isfinite(x)] for key in keys}
    controller = {"kind": c.kind, "coordinates": c.coordinates, **gains}
    controller |= {"period_s": c.period_s, "velocity": c.velocity}
    units = {
        kind: [KINDS[kind][unit == "m"] for unit in recording.units]
        for kind in ("position", "velocity", "torque")
    }
    return {
        "format": 1,
        "name": recording.name,
        "table": table,
        "rig": recording.rig,
        "coordinates": recording.coordinates,
        "axes": list(recording.axes),
        "guessed_units": list(recording.guessed_units),
        "columns": columns,
        "units": {"time": "s", **{k: u[0] if len(set(u)) == 1 else u for k, u in units.items()}},
        **({} if c == Controller() else {"controller": _present(controller)}),
        "excitation": _present(vars(recording.excitation)),
        "timing": _present(vars(recording.timing)),
    }


def _present(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None and value != []}
