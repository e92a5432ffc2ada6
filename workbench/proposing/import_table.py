"""A recording of any table or log in one call, for scripts and notebooks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core import InputError, Recording
from workbench.effects import axis_units, load_model
from workbench.models import Model

from .by_weight import by_weight
from .files import open_table
from .proposal import Answers, Question
from .propose import propose
from .table import Table
from .write import complete

_ROUNDS = 20  # an answer may open another question, but not for ever
#: The field of `Answers` that answers a question, by the first word of its key.
_FIELDS = {"unit": "units", "constant": "units", "column": "columns", "rate": "rate_hz"}
#: Questions whose answer is a number that nothing in a table hints at.
NUMBERS = frozenset({"rate", "counts"})


def import_table(
    path: str | Path, model: str | Model | None = None, *, likeliest: bool = False, **told: Any
) -> Recording:
    """The recording that a table or log holds; what its columns are is found, told by the model or by you.

    Args:
        path: CSV, JSON, Parquet, MATLAB, NumPy, MCAP, a CAN log: whatever `workbench import` reads.
        model: whose axes the recording is for, or its file; its weight and inertia may tell units.
        likeliest: take the likeliest answer to a question that is left.
        told: fields of `Answers`, such as ``axes=("hip", "knee")``, ``units={"position": "deg"}``,
            ``columns={"torque_measured": ("i1", "i2")}``, ``kp=(20.0,)``.

    Raises:
        InputError: the file cannot be read, or a question is left.
    """
    loaded = load_model(model) if isinstance(model, str) else model
    answers = Answers(**({} if loaded is None else said_by(loaded)) | told)
    table = open_table(Path(path), episode=answers.episode or 0)
    proposal = propose(table, answers)
    if loaded is not None:
        answers = by_weight(proposal, table, answers, loaded)
        proposal = propose(table, answers)
    for _ in range(_ROUNDS):
        asked = [q for q in proposal.questions if not (likeliest and q.best and q.key not in NUMBERS)]
        if not asked:
            break
        if not (likeliest and asked[0].best):
            raise _open(asked, table)
        answers = answers.with_answer(asked[0].key, asked[0].best)
        answers = replace(answers, guessed=answers.guessed | {asked[0].key})
        proposal = propose(table, answers)
    return complete(proposal, table, answers)[1]


def said_by(model: Model) -> dict[str, Any]:
    """What a model says of a recording that is made for it, as fields of `Answers`."""
    n = len(model.driven)
    transmission = model.transmission[:n, :n]
    return {
        "model_axes": model.driven,
        "linear": tuple(unit == "m" for unit in axis_units(model)[:n]),
        "transmission": None if np.array_equal(transmission, np.eye(n)) else transmission,
        "loop": model.controller.kind != "unknown",
        "floats": model.floats,
    }


def _open(asked: list[Question], table: Table) -> InputError:
    fields = dict.fromkeys(_FIELDS.get(kind := q.key.split(".")[0], kind) for q in asked)
    remedy = f"pass {', '.join(f'{name}=...' for name in fields)}"
    return InputError(
        f"cannot be told: {' '.join(q.text for q in asked)}",
        file=table.file,
        remedy=f"{remedy}, or likeliest=True" if all(q.best for q in asked) else remedy,
    )
