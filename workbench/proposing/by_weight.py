"""Units found from weight and inertia of a model: with wrong units, its motion needs another torque."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from workbench.comparison import is_weighable, torque_left
from workbench.core import InputError, SimulationError
from workbench.models import Model

from .proposal import Answers, Proposal, Question
from .propose import propose
from .table import Table
from .write import complete

_GOOD = 0.25  # share of the torque that a model leaves which lacks an effect
_CLEAR = 0.25  # of what the next best unit leaves
_TURNING = ("rad", "deg", "turn")
_ASKED = ("unit", "unit.position", "unit.torque")
_TORQUES = ("N*m", "N*mm", "cN*m")


def by_weight(proposal: Proposal, table: Table, answers: Answers, model: Model) -> Answers:
    """Return the answers with units of the motion found from the model; unchanged if it determines none.

    Asked is what is open, and what only the size of the numbers tells where the model contradicts it.

    Args:
        proposal: what was worked out without the model.
        table: the columns.
        answers: what the user says.
        model: whose axes the recording is for.
    """
    taken = _left(table, answers, model)
    if taken is None:
        return answers
    asked = [q for q in proposal.questions if q.key in _ASKED]
    guesses = [kind for kind in ("position", "torque") if _is_guess(proposal, answers, kind)]
    if not asked and (taken <= _GOOD or not guesses):
        return answers
    others = list(_others(asked, guesses, answers))
    left = [_left(table, other, model) for other in others]
    told = sorted((x, k) for k, x in enumerate(left) if x is not None)
    if len(told) < 2 or told[0][0] > min(_GOOD, _CLEAR * told[1][0]):
        return answers
    chosen = others[told[0][1]]
    why = (
        f"the model's weight and inertia: {100 * told[0][0]:.2g} % of the torque remains unexplained, "
        f"{_share(told[1][0])} in the next best"
    )
    new = chosen.units.keys() - answers.units.keys()
    return replace(chosen, weighed={**answers.weighed, **dict.fromkeys(new, why)})


def _others(asked: list[Question], guesses: list[str], answers: Answers) -> Iterator[Answers]:
    """Every unit that may be, of one kind at a time."""
    if asked:
        # what is as large by another name is no other answer
        choices = [c for c in asked[0].choices or _TURNING if c != "mN*m"]
        yield from (answers.with_answer(asked[0].key, choice) for choice in choices)
    else:
        choices = {"position": _TURNING, "torque": _TORQUES}
        yield from (answers.with_answer(f"unit.{kind}", unit) for kind in guesses for unit in choices[kind])


def _is_guess(proposal: Proposal, answers: Answers, kind: str) -> bool:
    said = {kind, "velocity" if kind == "position" else kind} & answers.units.keys()
    because = next((a.because for a in proposal.assumptions if a.what == f"unit of {kind}"), "")
    return not said and because.startswith("numbers")


def _left(table: Table, answers: Answers, model: Model) -> float | None:
    """Share of the torque that is left in the likeliest units; None where it cannot be asked."""
    try:
        _, recording = complete(propose(table, answers), table, answers)
        if tuple(recording.axes) != tuple(model.axes) or not is_weighable(model, [recording]):
            return None
        return float(np.mean(torque_left(model, [recording])))
    except (InputError, SimulationError):
        return None


def _share(left: float) -> str:
    return f"{100 * left:.2g} %" if left < 1.0 else "all of it"
