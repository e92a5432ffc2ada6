"""A proposal during construction: inputs, assumptions, questions and notes so far."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from .names import Role
from .proposal import Answers, Assumption, Question
from .table import Table

FALLBACK_RATE = 100.0  # rows per second, for looking at the rest while the question is open


@dataclass
class Draft:
    """Inputs and results of a proposal; its parts add to the lists.

    Attributes:
        table: the columns.
        answers: what the user says already.
        roles: column -> what its name says.
    """

    table: Table
    answers: Answers
    roles: dict[str, Role]
    assumed: list[Assumption] = field(default_factory=list)
    questions: list[Question] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def assume(self, what: str, value: str, sure: float, because: str) -> None:
        """Add an assumption."""
        self.assumed.append(Assumption(what, value, sure, because))

    def unsure(self, what: str, sure: float, value: str | None = None) -> None:
        """Make an assumption less certain than noted, or change its value."""
        self.assumed = [
            replace(a, sure=min(a.sure, sure), value=a.value if value is None else value)
            if a.what == what
            else a
            for a in self.assumed
        ]
