"""A recording's table and its TOML."""

from __future__ import annotations

import gzip
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import tomli_w
from scipy.io import savemat

AXES = "hip", "knee"
ROWS, PERIOD_S = 240, 0.005


def table() -> dict[str, np.ndarray]:
    """Two driven axes that move as no sine does, their derivatives right."""
    t = np.arange(ROWS) * PERIOD_S
    out = {"t": np.round(t, 9)}
    for i, axis in enumerate(AXES):
        a, b = 12.0 + i, 31.0 + 3.0 * i
        q = 0.3 * np.sin(a * t) + 0.1 * np.sin(b * t + i)
        out[f"q_{axis}"] = q
        out[f"w_{axis}"] = 0.3 * a * np.cos(a * t) + 0.1 * b * np.cos(b * t + i)
        out[f"tau_{axis}"] = 2.0 * np.sin(a * t + 0.3)
        out[f"cmd_{axis}"] = 2.1 * np.sin(a * t + 0.25)
        out[f"ref_{axis}"] = 0.31 * np.sin(a * t + 0.1)
    return out


def description(file: str) -> dict[str, Any]:
    """The TOML of `table` in a file."""
    columns = {
        "position": "q", "velocity": "w", "torque_measured": "tau", "torque_command": "cmd",
        "position_reference": "ref",
    }  # fmt: skip
    return {
        "format": 1,
        "name": "run",
        "table": file,
        "rig": "leg",
        "coordinates": "actuator",
        "axes": list(AXES),
        "columns": {
            "time": "t",
            **{signal: [f"{short}_{axis}" for axis in AXES] for signal, short in columns.items()},
        },
        "units": {"time": "s", "position": "rad", "velocity": "rad/s", "torque": "N*m"},
        "controller": {
            "kind": "pd", "coordinates": "joint", "kp": [50.0, 50.0], "kd": [1.5, 1.5], "period_s": 0.005,
        },
        "excitation": {
            "kind": "multisine", "mode": "sum", "period_s": 0.6, "f_min_hz": 1.0, "f_max_hz": 40.0,
        },
        "timing": {"feedforward_held": True, "initial_at_rest": False, "delay": "motor"},
    }  # fmt: skip


def csv(columns: Mapping[str, Any], separator: str = ",") -> bytes:
    """Columns as text; they may be of different lengths."""
    length = max((len(v) for v in columns.values()), default=0)
    rows = [[_cell(v[k]) if k < len(v) else "" for v in columns.values()] for k in range(length)]
    return "\n".join(separator.join(row) for row in [list(columns), *rows]).encode("utf-8", "replace") + b"\n"


def _cell(value: Any) -> str:
    return repr(float(value)) if isinstance(value, float | np.floating) else str(value)


def write_table(path: Path, columns: Mapping[str, Any]) -> None:
    """Columns in the format that a file's name says; may raise whatever its writer does."""
    name = path.name
    if name.endswith(".csv.gz"):
        path.write_bytes(gzip.compress(csv(columns), 1, mtime=0))
    elif name.endswith((".csv", ".txt", ".tsv")):
        path.write_bytes(csv(columns, {".csv": ",", ".txt": " ", ".tsv": "\t"}[path.suffix]))
    elif name.endswith(".parquet"):
        pq.write_table(pa.table({n: pa.array(list(v)) for n, v in columns.items()}), path)
    elif name.endswith(".mat"):
        savemat(path, dict(columns))
    elif name.endswith(".npz"):
        np.savez(path, **{n: v for n, v in columns.items() if v.dtype != object})
    elif name.endswith((".json", ".jsonl")):
        lists = {n: np.asarray(v).tolist() for n, v in columns.items()}
        records = [dict(zip(lists, cells, strict=False)) for cells in zip(*lists.values(), strict=False)]
        lines = [json.dumps(record, default=str) for record in records]
        path.write_text("\n".join(lines) if name.endswith("l") else json.dumps(lists, default=str))
    else:
        array = np.stack([np.asarray(v, float) for v in columns.values()], axis=1)
        np.save(path, array)


def recording(folder: Path, file: str = "run.csv") -> None:
    """``run.toml`` and its table."""
    write_table(folder / file, table())
    (folder / "run.toml").write_text(tomli_w.dumps(description(file)))
