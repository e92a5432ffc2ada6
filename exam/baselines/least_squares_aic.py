"""Least squares on inverse dynamics, effects added by AIC."""

from stepwise import stepwise
from workbench_exam.answers import Answer
from workbench_exam.cases import Case


def solve(case: Case) -> Answer:
    """Forward selection by AIC."""
    return stepwise(case, aic=True)
