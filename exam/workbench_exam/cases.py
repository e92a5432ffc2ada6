"""A case as a solver has it: a model, recordings in SI units, and what is known of the loop."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .reading import read_json

#: Signals of a recording, in the order of its columns.
SIGNALS = ("position", "position_reference", "velocity", "torque_command", "torque_measured")
#: Kind of a signal -> what one of its unit is in SI.
UNITS: Mapping[str, float] = {
    "s": 1.0, "ms": 1e-3, "rad": 1.0, "deg": np.pi / 180, "m": 1.0,
    "rad/s": 1.0, "m/s": 1.0, "rpm": np.pi / 30, "N m": 1.0, "N": 1.0, "N mm": 1e-3,
}  # fmt: skip


@dataclass(frozen=True)
class Recording:
    """One run of the machine; signals (N, n) of its drives, SI; what was not logged is absent."""

    name: str
    time: np.ndarray
    signals: Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Case:
    """One question.

    Attributes:
        folder: with `model.xml` and `model.urdf`, for libraries that read these.
        name: of the folder. drives: names, in the order of all columns.
        couple: angles of drives over those of joints (n, n), joints in the model's order.
        kp, kd: torque = kp (reference - position) - kd velocity, sampled each `period` [s] and held.
        driven: whether a motor is there.
        known: all that `case.json` says.
        recordings: to use as one likes.
    """

    folder: Path
    name: str
    drives: tuple[str, ...]
    couple: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    period: float
    driven: tuple[bool, ...]
    known: Mapping[str, Any]
    recordings: tuple[Recording, ...]


def read_case(folder: Path) -> Case:
    """Reads a case's folder.

    Raises:
        ValueError: what it holds is not what the exam wrote.
        FileNotFoundError: a file is missing.
    """
    try:
        return _case(folder, read_json(folder / "case.json"))
    except (KeyError, TypeError, IndexError, ValueError) as error:
        raise ValueError(f"{folder}: damaged, make it again: {type(error).__name__}: {error}") from error


def _case(folder: Path, known: Mapping[str, Any]) -> Case:
    law = known["controller"]
    return Case(
        folder,
        folder.name,
        tuple(known["drives"]),
        np.array(known["drive_angles_over_joint_angles"], float),
        np.array(law["kp"]),
        np.array(law["kd"]),
        law["period_s"],
        tuple(known["driven"]),
        known,
        tuple(_recording(folder, known, name) for name in known["recordings"]),
    )


def _recording(folder: Path, known: Mapping[str, Any], name: str) -> Recording:
    with (folder / name).open(newline="") as file:
        header = next(csv.reader(file), [])
        rows = file.readlines()
    if not rows:
        raise ValueError(f"{name} has no rows")
    table = np.loadtxt(rows, delimiter=",", ndmin=2)
    columns = dict(zip(header, table.T, strict=True))
    signals = {}
    for signal in SIGNALS:
        if f"{signal}_{known['drives'][0]}" in columns:
            units = known["units"][signal]
            signals[signal] = np.column_stack(
                [columns[f"{signal}_{d}"] * UNITS[u] for d, u in zip(known["drives"], units, strict=True)]
            )
    return Recording(Path(name).stem, columns["time"] * UNITS[known["units"]["time"]], signals)
