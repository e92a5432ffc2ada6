"""What an import cannot tell: asked at a terminal until an answer is one, else refused with its table."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

from workbench.core import InputError

from .common import echo
from .heartbeat import waiting

if TYPE_CHECKING:
    from workbench.proposing import Answers, Proposal, Question, Table

_YES, _NO = ("y", "yes", "ja"), ("n", "no", "nein")
_TRIES = 5  # wrong answers to one question; a mistake may lie elsewhere, so nobody is asked for ever


def answered(
    proposal: Proposal,
    questions: Sequence[Question],
    answers: Answers,
    table: Table,
    *,
    yes: bool,
    silent: bool,
) -> Answers:
    """One more answer: from the user, or the likeliest.

    Args:
        proposal: what was worked out; shown where nobody can be asked.
        questions: those that are open.
        answers: what is known.
        table: what an answer is tried on.
        yes: take the likeliest.
        silent: show nothing.

    Raises:
        InputError: nobody can be asked, there is no likeliest answer, or no answer was one.
    """
    if yes:
        for question in questions:
            if question.best:
                return answers.with_guess(question)
    elif sys.stdin.isatty() and sys.stderr.isatty():
        return _asked(questions[0], answers, table)
    if not silent:
        from workbench import report

        from .import_tables import assumed_table

        report.print_table(
            assumed_table(proposal, f"{table.file.name}: {len(table)} rows; not finished: a question is open")
        )
    texts = " ".join(q.text for q in questions)
    remedy = "pass " + " ".join(q.option for q in questions)
    if not yes and all(q.best for q in questions):
        remedy += ", or --yes for the likeliest answers"
    raise InputError(f"needs an answer. {texts}", file=table.file, remedy=remedy)


def _asked(question: Question, answers: Answers, table: Table) -> Answers:
    from workbench.proposing import propose

    is_it_so = bool(question.best) and len(question.choices) <= 1
    echo(question.text, err=True)  # standard output is the result's
    for number, choice in enumerate(() if is_it_so else question.choices, 1):
        echo(f"  {number}  {choice}", err=True)
    possible = _possible(question)
    if is_it_so:
        echo(possible, err=True)
    default = "y" if is_it_so else question.best or None
    for tried in range(1, _TRIES + 1):
        with waiting():
            text = str(typer.prompt("Answer", default=default, err=True)).strip()
        if text.lower() in _NO and text not in question.choices:
            echo(f"Then what is it? {possible}" if is_it_so else possible, err=True)
            continue
        if is_it_so and text.lower() in _YES:
            text = question.best
        elif text.isdigit() and 1 <= int(text) <= len(question.choices):
            text = question.choices[int(text) - 1]
        try:
            new = answers.with_answer(question.key, text)
            propose(table, new)
        except ValueError:
            echo(f"'{text}' is not an answer to that. {possible}", err=True)
        except InputError as error:
            if tried == _TRIES:
                raise
            echo(f"With '{text}': {error.problem}. {possible}", err=True)
        else:
            return new
    raise InputError(f"needs an answer. {question.text}", file=table.file, remedy=f"pass {question.option}")


def _possible(question: Question) -> str:
    """What may be answered."""
    if question.key == "axes":
        names = question.best.replace(",", ", ")
        return f"Answer y, or give the names {names} in the order of the file's joints, with commas between."
    if question.choices:
        return "Give one of these, by its number or its name."
    return "Answer y, or give a number above zero." if question.best else "Give a number above zero."
