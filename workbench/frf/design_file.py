"""A design on disk: one TOML file, and one table per experiment that a rig can play."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tomli_w
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from workbench.core import InputError
from workbench.core.files import check_format, check_free, read_toml, write_all
from workbench.core.grammar import explained
from workbench.core.unfinished import finish
from workbench.recordings.tables import read_table
from workbench.recordings.tables.csv_table import csv_bytes

from .excitation import Design, Trial

_SHORT = {"torque_feedforward": "ff", "position_reference": "qref"}


# far beyond any experiment, and small enough that their product is a number
_Positive = Annotated[FiniteFloat, Field(gt=0.0, lt=1e9)]
_Count = Annotated[int, Field(ge=0, lt=2**31)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class _TrialTable(_Table):
    name: str
    table: str
    mode: Literal["sum", "difference", "single"] | None = None
    realisation: int = 0
    excitation: dict[str, Any] = {}


class _DesignTable(_Table):
    format: Literal[1]
    design: str
    kind: Literal["multisine", "chirp"]
    axes: list[str]
    driven: Literal["torque_feedforward", "position_reference"]
    rate_hz: _Positive
    period_s: _Positive
    periods: _Count
    transient_periods: _Count
    grid: Literal["full", "odd", "odd_random"]
    lines: list[_Count]
    hold: list[FiniteFloat] = []
    fade_s: Annotated[FiniteFloat, Field(ge=0.0)] = 0.0
    trials: list[_TrialTable]


def save_design(design: Design, path: str | Path, *, force: bool = False) -> list[Path]:
    """Write a design that `load_design` reads back and a rig can play; return the paths.

    Beside the TOML stands one ``.csv.gz`` an experiment: ``t`` [s], ``ff_AXIS`` (torque on top of the
    feedback) and/or ``qref_AXIS`` (position reference), all periods, transient ones first. Each trial's
    ``excitation`` is what the recording of it says in its own ``[excitation]``.

    Returns:
        The files written, the TOML last.

    Raises:
        InputError: a file is there and `force` is not given, or the folder cannot be written.
    """
    path = Path(path)
    if path.suffix != ".toml":
        raise InputError("does not end in .toml", file=path, remedy="name the design's TOML file")
    tables = [path.with_name(f"{trial.name}.csv.gz") for trial in design.trials]
    for file in (*tables, path):
        check_free(file, force=force)
    trials = []
    for e, (trial, table) in enumerate(zip(design.trials, tables, strict=True)):
        excitation = {k: v for k, v in vars(design.excitation(e)).items() if v is not None}
        entry = {"name": trial.name, "table": table.name, "realisation": trial.realisation}
        trials.append({**entry, **({"mode": trial.mode} if trial.mode else {}), "excitation": excitation})
    content = {
        "format": 1,
        "design": design.name,
        "kind": design.kind,
        "axes": list(design.axes),
        "driven": design.driven,
        "rate_hz": float(design.rate_hz),
        "period_s": design.period_s,
        "periods": design.periods,
        "transient_periods": design.transient_periods,
        "grid": design.grid,
        "lines": design.lines.tolist(),
        "hold": list(design.hold),
        "fade_s": float(design.fade_s),
        "trials": trials,
    }
    played = {table: _csv(design, e) for e, table in enumerate(tables)}
    return write_all({**played, path: tomli_w.dumps(content)}, force=force)


def load_design(path: str | Path) -> Design:
    """Return the design of a file.

    Raises:
        InputError: a missing or malformed file, or a table that is not of that design.
    """
    path = Path(path)
    d = _read(path)
    rows = round(d.period_s * d.rate_hz)
    signals = []
    for trial in d.trials:
        if Path(trial.table).name != trial.table:
            raise InputError(
                f"'{trial.table}' is not a file name", file=path, column="trials.table",
                remedy="put the table beside the design",
            )  # fmt: skip
        table = path.parent / trial.table
        columns = [f"{_SHORT[d.driven]}_{axis}" for axis in d.axes]
        data = read_table(table, ["t", *columns])
        played = np.column_stack([data[column] for column in columns])
        if len(played) != rows * (d.periods + d.transient_periods):
            raise InputError(
                f"has {len(played)} rows where {d.periods + d.transient_periods} periods have "
                f"{rows * (d.periods + d.transient_periods)}",
                file=table,
                remedy="write the design again",
            )
        # the last period: the first may be faded in
        offset = np.array(d.hold) if d.hold and d.driven == "position_reference" else 0.0
        signals.append(played[-rows:] - offset)
    try:
        return _design(d, np.stack(signals))
    except InputError as error:
        raise InputError(error.problem, file=path, column=error.column, remedy=error.remedy) from error


def _design(d: _DesignTable, experiments: np.ndarray) -> Design:
    return Design(
        name=d.design,
        kind=d.kind,
        axes=tuple(d.axes),
        driven=d.driven,
        rate_hz=d.rate_hz,
        experiments=experiments,
        lines=np.array(d.lines, int),
        trials=tuple(Trial(t.name, t.mode, t.realisation) for t in d.trials),
        grid=d.grid,
        periods=d.periods,
        transient_periods=d.transient_periods,
        hold=tuple(d.hold),
        fade_s=d.fade_s,
    )


def _read(path: Path) -> _DesignTable:
    finish(path.parent)
    content = read_toml(path)
    check_format(content, 1, path)
    try:
        table = _DesignTable.model_validate(content)
    except ValidationError as error:
        raise explained(error, _DesignTable, content, path) from error
    if not table.axes or not table.trials or not table.lines:
        remedy = "name axes, lines and trials"
        raise InputError("describes no experiment", file=path, column="trials", remedy=remedy)
    return table


def _csv(design: Design, experiment: int) -> bytes:
    time, signals = design.play(experiment)
    columns = {"t": np.round(time, 12)}
    for signal, values in signals.items():
        for axis, column in zip(design.axes, values.T, strict=True):
            columns[f"{_SHORT[signal]}_{axis}"] = column
    return csv_bytes(columns)
