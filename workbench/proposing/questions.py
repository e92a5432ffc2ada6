"""Asks questions about a table until none is open."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from workbench.models import Model

from .by_weight import by_weight
from .proposal import Answers, Proposal, Question
from .propose import propose
from .table import Table

#: Questions whose answer is a number that nothing in a table hints at: of these none is the likeliest.
_NUMBERS = frozenset({"rate", "counts"})
_ROUNDS = 12  # questions in a row; each answer may raise one more, but not for ever

Ask = Callable[[Proposal, Sequence[Question], Answers], Answers]


def told(
    table: Table, answers: Answers, ask: Ask, *, model: Model | None = None, likeliest: bool = False
) -> tuple[Proposal, Answers]:
    """Return the proposal for a table with all questions answered, and the answers.

    Args:
        table: the columns.
        answers: what the user said at first.
        ask: gives answers to one more of the questions that are open.
        model: whose axes the recording is for; its weight and inertia may tell units.
        likeliest: do not ask for units, axes and run: a proposal has the likeliest, told as guesses.
    """
    proposal = propose(table, answers)
    if model is not None:
        answers = by_weight(proposal, table, answers, model)
        proposal = propose(table, answers)
    for _ in range(_ROUNDS):
        asked = tuple(q for q in proposal.questions if not (likeliest and q.best and q.key not in _NUMBERS))
        if not asked:
            break
        answers = ask(proposal, asked, answers)
        proposal = propose(table, answers)
    return proposal, answers
