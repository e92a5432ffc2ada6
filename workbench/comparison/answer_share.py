"""How far a residual torque agrees with one of two assumptions about the loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_BLOCKS = 5


@dataclass(frozen=True)
class Asked:
    """Data of one axis: residual torque of the law against measurement or model (M,), its change under each
    assumption (M, A), and under numbers that may be wrong (M, C).
    """

    lacking: np.ndarray
    answers: np.ndarray
    inertia: np.ndarray
    damping: np.ndarray
    others: np.ndarray


def joined(parts: Sequence[Asked]) -> Asked:
    """Return the data of one axis, joined over all recordings."""
    return Asked(*(np.concatenate([getattr(p, f) for p in parts]) for f in Asked.__dataclass_fields__))


def answer_share(beside: Sequence[np.ndarray], axes: Sequence[Asked], answer: int) -> tuple[float, float]:
    """Return how far the residual torque agrees with one assumption, and the standard deviation from leaving
    out blocks.

    `beside`: columns (M, C) of each axis that are fitted with it. What they take up says nothing.
    """
    sums = np.zeros((_BLOCKS, 2))
    for columns, axis in zip(beside, axes, strict=True):
        base, _ = np.linalg.qr(columns / np.maximum(np.abs(columns).max(axis=0, initial=0.0), 1e-300))
        way, lacking = (x - base @ (base.T @ x) for x in (axis.answers[:, answer], axis.lacking))
        scale = max(float(lacking @ lacking), 1e-300)
        for block, rows in enumerate(np.array_split(np.arange(len(way)), _BLOCKS)):
            sums[block] += -way[rows] @ lacking[rows] / scale, way[rows] @ way[rows] / scale
    top, bottom = sums.sum(axis=0)
    if not (bottom - sums[:, 1] > 0.0).all():
        return 0.0, np.inf
    without = (top - sums[:, 0]) / (bottom - sums[:, 1])
    jackknife = (_BLOCKS - 1) / _BLOCKS * np.sum((without - without.mean()) ** 2)
    return float(top / bottom), float(np.sqrt(jackknife))
