"""Forward selection by an information criterion, for `least_squares_bic.py` and `least_squares_aic.py`.

The textbook way: effects are added one by one as long as the criterion falls (H. Akaike, IEEE Trans. Autom.
    Control 19, 1974; G. Schwarz, Ann. Stat. 6, 1978); nothing that only takes energy comes out negative in
    all. It knows no loop and nothing that is not linear in the torque.
"""

from __future__ import annotations

import numpy as np
from columns import Candidate
from dynamics import regression
from path import command_path
from workbench_exam.answers import Answer, Named
from workbench_exam.cases import Case

_MOST = 6  # effects
_LEAST = 0.03  # of the residual's squares that an effect takes: below it model errors of the filter are named
_ROUNDING = 1e-3  # of a criterion: a difference that says nothing
_SPAN = 1.959964
_POSITIVE = ("drag", "stiffness", "mass", "coulomb", "static")


def stepwise(case: Case, aic: bool) -> Answer:
    """Names effects by forward selection."""
    rows = regression(case)
    late = command_path(case)
    price = 2.0 if aic else float(np.log(len(rows.y)))
    chosen: list[Candidate] = []
    best = score(rows.y, chosen, price)
    while len(chosen) < _MOST:
        keys = {(c.effect, c.place) for c in chosen}
        scores = [
            (score(rows.y, [*chosen, c], price), k)
            for k, c in enumerate(rows.candidates)
            if (c.effect, c.place) not in keys
        ]
        worth = {k: value for value, k in scores}
        for k in ranked(scores):
            value, more = worth[k], [*chosen, rows.candidates[k]]
            if value < best and physical(estimates(rows.y, more)):
                break
        else:
            break
        if not aic and squares(rows.y, more) > (1.0 - _LEAST) * squares(rows.y, chosen):
            break
        chosen, best = more, value
    named = [*late, *estimates(rows.y, chosen)]
    return Answer("missing_effect" if named else "consistent", tuple(named))


def ranked(scores: list[tuple[float, int]]) -> list[int]:
    """Numbers by their criterion, least first; of those that are one but for rounding the lowest first.

    A link that turns with its rotor has the rotor's column: which of both is less by rounding is a matter of
    the processor.
    """
    groups: list[list[tuple[float, int]]] = []
    for value, k in sorted(scores):
        if not groups or value - groups[-1][0][0] > _ROUNDING:
            groups.append([])
        groups[-1].append((value, k))
    return [k for group in groups for k in sorted(k for _, k in group)]


def goes_with(y: np.ndarray, pool: list[Candidate]) -> Candidate:
    """The candidate that leaves least of `y`; of several alike the first."""
    return pool[ranked([(score(y, [c], 0.0), k) for k, c in enumerate(pool)])[0]]


def squares(y: np.ndarray, chosen: list[Candidate]) -> float:
    """What is left of the squares of `y`."""
    if not chosen:
        return float(y @ y)
    columns = np.concatenate([c.columns for c in chosen], axis=1)
    left = y - columns @ np.linalg.lstsq(columns, y, rcond=1e-9)[0]
    return float(left @ left)


def score(y: np.ndarray, chosen: list[Candidate], price: float) -> float:
    """The criterion."""
    return len(y) * float(np.log(squares(y, chosen) / len(y))) + price * sum(
        c.columns.shape[1] for c in chosen
    )


def estimates(y: np.ndarray, chosen: list[Candidate]) -> list[Named]:
    """Values with 95 % intervals from the residual."""
    if not chosen:
        return []
    columns = np.concatenate([c.columns for c in chosen], axis=1)
    factors = np.linalg.lstsq(columns, y, rcond=1e-9)[0]
    left = y - columns @ factors
    covariance = np.linalg.pinv(columns.T @ columns) * (left @ left) / (len(y) - len(factors))
    named, start = [], 0
    for c in chosen:
        own = slice(start, start + c.columns.shape[1])
        start = own.stop
        values = {}
        for name, (value, slope) in c.reading(factors[own]).items():
            half = _SPAN * float(np.sqrt(slope @ covariance[own, own] @ slope))
            values[name] = (value, value - half, value + half)
        named.append(Named(c.effect, c.place, values))
    return named


def physical(named: list[Named]) -> bool:
    """Whether nothing that only takes energy, or is a mass, comes out negative."""
    return all(v[0] >= 0.0 for each in named for name, v in each.values.items() if name in _POSITIVE)
