"""Makes a recording of any table or log in one call, for scripts and notebooks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core import InputError, Recording
from workbench.core.files import as_path
from workbench.effects import axis_units, load_model
from workbench.models import Model, servos_of

from .files import open_table
from .proposal import Answers, Proposal, Question, listed
from .questions import told
from .table import Table
from .write import complete

#: Fields of `Answers`, each with the type that its annotation begins with.
_KINDS = {f.name: str(f.type).partition("[")[0] for f in fields(Answers)}
#: The field of `Answers` that answers a question, by the first word of its key.
_FIELDS = {"unit": "units", "constant": "units", "column": "columns", "rate": "rate_hz"}


def import_table(
    path: str | Path, model: str | Path | Model | None = None, *, likeliest: bool = False, **said: Any
) -> Recording:
    """Return the recording of a table or log; columns' meaning is found, or stated by model or you.

    Args:
        path: CSV, JSON, Parquet, MATLAB, NumPy, MCAP, a CAN log: whatever `workbench import` reads.
        model: whose axes the recording is for, or its file; its weight and inertia may tell units.
        likeliest: take the likeliest answer to a question that is left.
        said: fields of `Answers`, such as ``axes=("hip", "knee")``, ``units={"position": "deg"}``,
            ``columns={"torque_measured": ("i1", "i2")}``, ``kp=(20.0,)``.

    Raises:
        InputError: the file cannot be read, an argument is not of its kind, or a question is left.
    """
    loaded = None if model is None else load_model(model)
    stated = {name: _said(name, value) for name, value in said.items()}
    answers = Answers(**({} if loaded is None else said_by(loaded)) | stated)
    table = open_table(as_path(path, "a table or log", "name its file"), episode=answers.episode or 0)

    def ask(_: Proposal, asked: Sequence[Question], now: Answers) -> Answers:
        if not (likeliest and asked[0].best):
            raise _open(asked, table)
        return now.with_guess(asked[0])

    proposal, answers = told(table, answers, ask, model=loaded, likeliest=likeliest)
    return complete(proposal, table, answers)[1]


def said_by(model: Model) -> dict[str, Any]:
    """Return what a model states of a recording that is made for it, as fields of `Answers`."""
    n = len(model.driven)
    transmission = model.transmission[:n, :n]
    return {
        "model_axes": model.driven,
        "linear": tuple(unit == "m" for unit in axis_units(model)[:n]),
        "transmission": None if np.array_equal(transmission, np.eye(n)) else transmission,
        "loop": model.controller.kind != "unknown",
        "servos": servos_of(model),
        "floats": model.floats,
    }


def _said(name: str, value: Any) -> Any:
    """Return the value of a field of `Answers`: one text or number where several may be is a list of one.

    Raises:
        InputError: there is no such field, or it is not of its kind.
    """
    if name not in _KINDS:
        raise InputError("there is no such argument", column=name, remedy=f"there are {', '.join(_KINDS)}")
    if _KINDS[name] == "Mapping" and not isinstance(value, Mapping):
        example = '{"position": "deg"}' if name == "units" else '{"position": ("q1", "q2")}'
        raise InputError("is not a dictionary", column=name, remedy=f"write for example {name}={example}")
    if name == "columns":
        return {signal: listed(c) if isinstance(c, str) else tuple(c) for signal, c in value.items()}
    if _KINDS[name] == "tuple":
        value = listed(value) if isinstance(value, str) else value
        return (value,) if isinstance(value, int | float) else tuple(value)
    return value


def _open(asked: Sequence[Question], table: Table) -> InputError:
    fields = dict.fromkeys(_FIELDS.get(kind := q.key.split(".")[0], kind) for q in asked)
    remedy = f"pass {', '.join(f'{name}=...' for name in fields)}"
    return InputError(
        f"needs an answer. {' '.join(q.text for q in asked)}",
        file=table.file,
        remedy=f"{remedy}, or likeliest=True" if all(q.best for q in asked) else remedy,
    )
