"""Least squares on torque residuals, effects added one by one as long as an information criterion falls.

The textbook way: filtered inverse dynamics, forward selection by AIC (H. Akaike, IEEE Trans. Autom. Control
19, 1974) or BIC (G. Schwarz, Ann. Stat. 6, 1978), no friction or mass below zero. It knows no noise floor, no
loop and nothing that is not linear in the torque; what it cannot see it calls consistent.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from exam.answers import Answer, Named

from workbench.core import Estimate, Recording

from .inverse_dynamics import Candidate, candidates, motion_of, needed

_MOST = 6  # effects
_NEVER_NEGATIVE = {
    "viscous_damping": ("damping",),
    "quadratic_drag": ("drag",),
    "coulomb_friction": ("torque",),
    "stribeck_friction": ("coulomb", "static"),
    "asymmetric_friction": ("torque_positive", "torque_negative"),
    "load_dependent_friction": ("torque", "ratio"),
    "parallel_spring": ("stiffness",),
    "reflected_inertia": ("inertia",),
    "payload_mass": ("mass",),
}


def least_squares(recordings: Sequence[Recording], criterion: Literal["aic", "bic"] = "bic") -> Answer:
    """Names effects by forward selection.

    Args:
        recordings: of the leg, with measured torque.
        criterion: what a further parameter has to pay.

    Raises:
        KeyError: a recording has no measured torque.
    """
    motion = motion_of(recordings)
    target = motion.smooth(motion.u - needed(motion.q, motion.w, motion.a))
    pool = [
        (candidate, np.stack([motion.smooth(column) for column in candidate.columns]))
        for candidate in candidates(motion)
    ]
    # each axis by what is left of it when everything is allowed: a fair guess of its noise
    everything = np.concatenate([columns for _, columns in pool])
    scale = np.array([_residual(everything[:, :, axis], target[:, axis]).std() for axis in range(2)])
    y = (target / scale).ravel()
    blocks = [(candidate, (columns / scale).reshape(len(columns), -1)) for candidate, columns in pool]
    price = np.log(len(y)) if criterion == "bic" else 2.0
    chosen: list[int] = []
    best = _score(y, np.empty((0, len(y))), price)
    while len(chosen) < _MOST:
        keys = {blocks[i][0].key for i in chosen}
        scores = {
            i: _score(y, np.concatenate([blocks[k][1] for k in [*chosen, i]]), price)
            for i, (candidate, _) in enumerate(blocks)
            if candidate.key not in keys
        }
        possible = (
            i
            for i in sorted(scores, key=lambda i: scores[i])
            if scores[i] < best and _physical(_named([blocks[k] for k in [*chosen, i]], y))
        )
        next_one = next(possible, None)
        if next_one is None:
            break
        best = scores[next_one]
        chosen.append(next_one)
    if not chosen:
        return Answer("consistent")
    return Answer("missing_effect", _named([blocks[i] for i in chosen], y))


def _residual(columns: np.ndarray, y: np.ndarray) -> np.ndarray:
    """What columns (K, N) leave of `y` (N,)."""
    if not len(columns):
        return y
    return y - columns.T @ np.linalg.lstsq(columns.T, y, rcond=1e-9)[0]


def _score(y: np.ndarray, columns: np.ndarray, price: float) -> float:
    left = _residual(columns, y)
    return len(y) * float(np.log(left @ left / len(y))) + price * len(columns)


def _physical(named: Sequence[Named]) -> bool:
    """Whether nothing that only takes energy, or is a mass, comes out negative."""
    return all(
        estimate.value >= 0.0
        for each in named
        for name, estimate in each.parameters.items()
        if name in _NEVER_NEGATIVE.get(each.key.effect, ())
    )


def _named(chosen: Sequence[tuple[Candidate, np.ndarray]], y: np.ndarray) -> tuple[Named, ...]:
    """Estimates with standard deviations from the residual, in the order in which they were chosen."""
    columns = np.concatenate([block for _, block in chosen])
    factors = np.linalg.lstsq(columns.T, y, rcond=1e-9)[0]
    left = y - columns.T @ factors
    covariance = np.linalg.pinv(columns @ columns.T) * (left @ left) / (len(y) - len(factors))
    named, start = [], 0
    for candidate, block in chosen:
        own = slice(start, start + len(block))
        start += len(block)
        parameters = {
            name: Estimate(value, float(np.sqrt(slope @ covariance[own, own] @ slope)), "")
            for name, (value, slope) in candidate.reading(factors[own]).items()
        }
        named.append(Named(candidate.key, parameters))
    return tuple(named)
