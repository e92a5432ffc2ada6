"""Sparse regression on inverse dynamics: PySINDy's thresholded least squares over all columns at once.

S. L. Brunton, J. L. Proctor and J. N. Kutz, PNAS 113, 2016. Threshold and ridge are chosen by BIC on a grid;
an effect is named where one of its columns is left. Needs `pip install pysindy`.
"""

from __future__ import annotations

import warnings
from itertools import product

import numpy as np
from columns import Candidate
from dynamics import regression
from path import command_path
from pysindy.optimizers import STLSQ
from stepwise import estimates, physical, score
from workbench_exam.answers import Answer
from workbench_exam.cases import Case

_PATH = np.geomspace(0.02, 0.8, 14)  # thresholds, of columns and target of unit size
_RIDGES = (1e-4, 1e-2, 1e-1)  # of the columns' own squares
_MOST = 8  # effects; more is no structure


def solve(case: Case) -> Answer:
    """Names what is left at the best threshold."""
    rows = regression(case)
    late = command_path(case)
    # of each grid (orders, Stribeck speeds) the best, as a library of one's own would have
    best: dict[tuple[str, str | None], Candidate] = {}
    for c in rows.candidates:
        key = c.effect, c.place
        if key not in best or score(rows.y, [c], 0.0) < score(rows.y, [best[key]], 0.0):
            best[key] = c
    pool = list(best.values())
    columns = np.concatenate([c.columns for c in pool], axis=1)
    owner = np.concatenate([np.full(c.columns.shape[1], k) for k, c in enumerate(pool)])
    x = columns / np.sqrt(np.mean(columns**2, axis=0))
    y = rows.y / np.sqrt(np.mean(rows.y**2))
    price = float(np.log(len(y)))
    choice: list[Candidate] = []
    least = score(rows.y, choice, price)
    for threshold, ridge in product(_PATH, _RIDGES):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            fit = STLSQ(threshold=threshold, alpha=ridge * len(y), max_iter=50).fit(x, y[:, None])
        left = sorted(set(owner[np.abs(fit.coef_[0]) > 0.0]))
        chosen = [pool[k] for k in left]
        if 0 < len(chosen) <= _MOST and physical(estimates(rows.y, chosen)):
            value = score(rows.y, chosen, price)
            if value < least:
                choice, least = chosen, value
    named = [*late, *estimates(rows.y, choice)]
    return Answer("missing_effect" if named else "consistent", tuple(named))
