"""Least squares on inverse dynamics, effects added by BIC."""

from stepwise import stepwise
from workbench_exam.answers import Answer
from workbench_exam.cases import Case


def solve(case: Case) -> Answer:
    """Forward selection by BIC."""
    return stepwise(case, aic=False)
