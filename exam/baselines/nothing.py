"""Sees nothing: what a table's least row is."""

from workbench_exam.answers import Answer
from workbench_exam.cases import Case


def solve(case: Case) -> Answer:
    """Every case is consistent."""
    return Answer("consistent")
