"""Tests a proposal, completes it from the recording, and writes it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import tomli_w

from workbench.core import InputError, Recording
from workbench.core.files import write_all
from workbench.inspection.inspect import FEW
from workbench.recordings import load_recording
from workbench.recordings.tables.csv_table import csv_bytes

from .by_servos import by_servos, servos_hint
from .gains import gains_shown
from .law import find_law
from .proposal import UNKNOWN, Answers, Assumption, Proposal
from .table import Table


def complete(proposal: Proposal, table: Table, answers: Answers) -> tuple[Proposal, Recording]:
    """Return the proposal with controller and start filled in, and the recording as it will be read.

    Raises:
        InputError: the recording reader refuses it, in the reader's own words.
    """
    with TemporaryDirectory() as folder:
        toml = Path(folder) / "proposal.toml"
        data = table.file.resolve()
        if proposal.data is not None:
            data = Path(folder) / "proposal.csv"
            data.write_bytes(csv_bytes(proposal.data, pack=False))
        write = lambda p: toml.write_bytes(_toml(p.description, str(data)))  # noqa: E731
        write(proposal)
        try:
            recording = load_recording(toml)
            controller, assumed, at_rest = _control(recording, answers)
            if proposal.description.get("controller") and not answers.kp:
                controller, assumed = {}, []  # its gains were logged
            description = {**proposal.description}
            if controller:
                description["controller"] = controller
            if not at_rest:
                description["timing"] = {"initial_at_rest": False}
                assumed = [*assumed, Assumption("start", "moving", 0.97, "speed of the first rows")]
            proposal = replace(
                proposal, description=description, assumptions=(*proposal.assumptions, *assumed)
            )
            write(proposal)
            recording = load_recording(toml)
            if len(recording) < FEW:
                proposal = replace(proposal, notes=(*proposal.notes, _short(recording)))
        except InputError as error:
            shown = table.file if str(error.file) in (str(data), str(toml)) else error.file
            raise InputError(
                error.problem, file=shown, column=error.column, row=error.row, remedy=error.remedy
            ) from error
    return proposal, replace(recording, name=table.file.stem, source=None)


def write(proposal: Proposal, table: Table, output: Path, *, force: bool = False) -> list[Path]:
    """Write the TOML file, and a table beside it if the file is no plain one.

    Returns:
        The files written.

    Raises:
        InputError: an output exists, or is the source itself.
    """
    if output.suffix != ".toml":
        raise InputError("does not end in .toml", file=output, remedy="e.g. -o run.toml")
    target = output.with_name(f"{output.stem}.table.csv.gz")
    if proposal.data is None:
        source = os.path.relpath(table.file.resolve(), output.resolve().parent)
        return write_all({output: _toml(proposal.description, source, output.stem)}, force=force)
    if target.resolve() == table.file.resolve():
        raise InputError("would overwrite the source", file=target, remedy="give another name with -o")
    toml = _toml(proposal.description, target.name, output.stem)
    return write_all({output: toml, target: csv_bytes(proposal.data)}, force=force)


def _short(recording: Recording) -> str:
    logged = "" if recording.get("position_reference") is None else " The reference is logged too."
    return f"{len(recording)} rows, {recording.duration:.3g} s: too short for a comparison.{logged}"


def _control(recording: Recording, answers: Answers) -> tuple[dict[str, Any], list[Assumption], bool]:
    """The ``[controller]`` table, what it rests on, and whether the run starts at rest."""
    n = len(recording.axes)
    at_rest = _starts_at_rest(recording)
    if answers.kp:
        gains = {"kp": _each(answers.kp, n, "--kp"), "kd": _each(answers.kd or (0.0,), n, "--kd")}
        table = {"kind": "pd", "coordinates": recording.coordinates, **gains}
        if answers.period_s:
            table["period_s"] = answers.period_s
        return table, [Assumption("controller", "pd", 1.0, "you said so")], at_rest
    law = find_law(recording, answers.transmission)
    made = None if law or answers.loop else by_servos(recording, answers.servos)
    if made:
        return made[0], [Assumption("controller", gains_shown(made[0]), 0.95, made[1])], at_rest
    if law is None:
        because = "no PD law gives the logged command; give --kp and --kd"
        if "velocity" in recording.derived:
            because = "the loop's speed is not logged; give --kp and --kd"
        if recording.get("torque_command") is None:
            because = (
                "no torque command is logged; name it (--column torque_command=…), or give --kp and --kd"
            )
            because += servos_hint(answers.servos)
        if len(recording) < FEW:
            because = "too few rows to tell; give --kp and --kd"
        if recording.get("position_reference") is None:
            because = "no reference is logged"
        elif answers.loop:
            return {}, [Assumption("controller", "the model's", 0.97, "the model states its loop")], at_rest
        return {}, [Assumption("controller", UNKNOWN, 0.98, because)], at_rest
    table = {
        "kind": "pd",
        "coordinates": law.coordinates,
        "kp": [float(f"{x:.4g}") for x in law.kp],
        "kd": [float(f"{x:.4g}") for x in law.kd],
        "period_s": float(f"{law.period_s:.9g}"),
    }
    shown = f"pd, kp {', '.join(f'{x:.4g}' for x in law.kp)}; kd {', '.join(f'{x:.4g}' for x in law.kd)}"
    because = "the command is that law" + (f" to {100 * law.rest:.1g} %" if law.rest > 1e-5 else "")
    return table, [Assumption("controller", shown, 0.99 if law.rest < 0.005 else 0.95, because)], at_rest


def _starts_at_rest(recording: Recording) -> bool:
    speed = np.abs(recording.velocity)
    # the very first row: an arm that is let go falls from the second on
    first = speed[0] if "velocity" not in recording.derived else np.median(speed[:3], axis=0)
    return bool(np.all(first <= 0.05 * np.quantile(speed, 0.99, axis=0) + 1e-9))


def _each(values: tuple[float, ...], n: int, option: str) -> list[float]:
    if len(values) not in (1, n):
        raise InputError(f"{len(values)} values of {option} for {n} axes", remedy="give one, or one per axis")
    return list(values) * (n if len(values) == 1 else 1)


def _toml(description: Mapping[str, Any], table: str, name: str | None = None) -> bytes:
    head = {"format": description["format"], **({"name": name} if name else {}), "table": table}
    rest = {k: v for k, v in description.items() if k != "format" and v != ""}
    return tomli_w.dumps({**head, **rest}).encode()
