"""Symbolic regression of each drive's lacking torque, read as the effect that it goes with most.

Genetic programming (gplearn) over angle, speed, direction and acceleration with +, -, x, sine and magnitude,
under its own price on length. One effect a drive. Needs `pip install gplearn`.
"""

from __future__ import annotations

import numpy as np
from columns import way
from dynamics import regression
from gplearn.genetic import SymbolicRegressor
from stepwise import estimates, goes_with
from workbench_exam.answers import Answer, Named
from workbench_exam.cases import Case

_LEARNS = 0.2  # of the variance that an expression must explain to speak
_AS_ONE = 0.5  # of the expression's variance that an effect must explain to be what it says


def solve(case: Case) -> Answer:
    """Names one effect for each drive whose lacking torque has an expression."""
    rows = regression(case)
    m = rows.motion
    driven = list(np.flatnonzero(case.driven))
    named: list[Named] = []
    strange = False
    for row, i in enumerate(driven):
        y = m["lacks"][:, i] / m["scale"][i]
        if float(np.mean(y**2)) < 1.2:  # what is left when everything is allowed has one
            continue
        x = np.column_stack([m["q"][:, i], m["w"][:, i], way(m["w"])[:, i], m["a"][:, i]])
        size = np.abs(x).max(axis=0) + 1e-12
        size[0] = 1.0  # of an angle the sine is taken
        search = SymbolicRegressor(
            population_size=400, generations=12, function_set=("add", "sub", "mul", "sin", "abs"),
            parsimony_coefficient=0.002, const_range=(-10.0, 10.0), random_state=0,
        )  # fmt: skip
        said = search.fit(x / size, y).predict(x / size)
        if 1.0 - np.mean((y - said) ** 2) / np.mean(y**2) < _LEARNS:
            strange = True
            continue
        whole = np.zeros((len(y), len(driven)))
        whole[:, row] = said
        pool = [c for c in rows.candidates if c.place in (case.drives[i], None)]
        best = goes_with(whole.ravel(), pool)
        columns = best.columns.reshape(len(y), len(driven), -1)[:, row]
        left = said - columns @ np.linalg.lstsq(columns, said, rcond=1e-9)[0]
        if float(left @ left) > (1.0 - _AS_ONE) * float(said @ said):
            strange = True
        elif (best.effect, best.place) not in {(each.effect, each.place) for each in named}:
            named += estimates(rows.y, [best])
    if not named:
        return Answer("unexplained" if strange else "consistent")
    return Answer("partly_explained" if strange else "missing_effect", tuple(named))
