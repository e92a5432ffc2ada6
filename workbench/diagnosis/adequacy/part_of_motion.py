"""The part of the motion where laws explain the torque; something unknown acts in the other part.

A rough patch, a cable that pulls at one end or a blow acts at some positions or for some time. Laws that are
fitted to all rows follow it. On the half of the motion that they fit best they are what they are elsewhere
(least trimmed squares: P. Rousseeuw, J. Am. Statist. Assoc. 79(388), 1984, by concentration steps:
P. Rousseeuw and K. Van Driessen, Technometrics 41(3), 1999); a half is the most that nobody can take for the
exception.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..fitting.normal_equations import normal, total
from ..policy import POLICY
from .laws import Laws, is_of_drives

_BINS = 20  # of each quantity, with as many rows in each
_STEPS = 20  # of concentration, far more than are ever needed


_Good = dict[int | None, np.ndarray]  # which bins of each quantity are good, (_BINS,)


@dataclass(frozen=True, eq=False)
class Part:
    """A part of the motion.

    Attributes:
        rows: that are explained, of each recording, (N,).
        drives: indices of those whose positions define it.
        basic: whether it is where inertia, damping and Coulomb friction explain most, but more than noise is
            left. What any other law explains there, it may have been chosen by.
    """

    rows: tuple[np.ndarray, ...]
    drives: frozenset[int]
    basic: bool = False


def explained_part(laws: Laws, position: Sequence[np.ndarray]) -> Part | None:
    """Return the part of the motion, at least half of it, where laws leave little more than noise.

    Without such a half it is where the laws that every drive has leave no more than an explanation may.

    Args:
        laws: with the torque that they have to explain.
        position: of the drives, (N, n) of each recording.

    Returns:
        None where it is the whole motion, or less than half of it, or where it has less than a bin's share of
        some recording: that one differs from the others, whatever the motion.
    """
    ends = np.cumsum([len(p) for p in position])
    time = [np.arange(end - len(p), end) for p, end in zip(position, ends, strict=True)]
    bins: dict[int | None, list[np.ndarray]] = {None: _bins(time)}
    bins |= {k: _bins([p[:, k] for p in position]) for k in range(len(laws.noise))}
    for basic in (False, True):
        acts = laws.acts[:, :, [is_of_drives(key) or not basic for key in laws.keys]]
        axes: dict[int, _Good] = {k: {} for k in laws.above_noise}
        for k, good in axes.items():
            for quantity, own in bins.items():
                there = np.concatenate([b[r] for b, r in zip(own, laws.rows, strict=True)])
                left, whole = _left(acts[:, k], laws.torque[:, k], there)
                enough = (1.0 - POLICY.explained) * whole if basic else POLICY.near_noise * laws.noise[k]
                good[quantity] = left <= enough
        if part := _most_of_it(axes, bins):
            return replace(part, basic=basic)
    return None


def _most_of_it(axes: Mapping[int, _Good], bins: Mapping[int | None, Sequence[np.ndarray]]) -> Part | None:
    """Return the rows in good bins of the quantity with most of these, where each axis has half of them."""
    rows, drives = [np.ones(len(b), bool) for b in bins[None]], set[int]()
    for good in axes.values():
        quantity = max(good, key=lambda q: int(good[q].sum()))
        if good[quantity].sum() >= _BINS // 2:
            rows = [a & good[quantity][b] for a, b in zip(rows, bins[quantity], strict=True)]
            drives |= set() if quantity is None else {quantity}
    whole = sum(len(r) for r in rows)
    if not 0.5 * whole <= sum(int(r.sum()) for r in rows) < whole or any(r.mean() < 1 / _BINS for r in rows):
        return None
    return Part(tuple(rows), frozenset(drives))


def _bins(values: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return the bin of each row of each recording; all bins have equally many rows."""
    edges = np.quantile(np.concatenate(values), np.linspace(0.0, 1.0, _BINS + 1)[1:-1])
    return [np.searchsorted(edges, v) for v in values]


def _left(laws: np.ndarray, torque: np.ndarray, bins: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean square in each bin that laws (M, E) and a constant leave, fitted to the best half of
    the bins, and that of the fit itself.
    """
    columns = np.column_stack([laws[:, laws.any(axis=0)], np.ones(len(torque))])
    columns = columns / np.sqrt(np.mean(columns**2, axis=0))
    pieces = [normal(columns[bins == b], torque[bins == b]) for b in range(_BINS)]

    def left(sizes: np.ndarray) -> np.ndarray:
        return np.array([p.after(sizes) / max(p.samples, 1) for p in pieces])

    sizes, half = np.linalg.lstsq(columns, torque, rcond=None)[0], set[int]()
    for _ in range(_STEPS):
        best = set(np.argsort(left(sizes))[: _BINS // 2].tolist())
        if best == half:
            break
        half = best
        whole = total([pieces[b] for b in half])
        sizes = np.linalg.lstsq(whole.gram, whole.right, rcond=None)[0]
    return left(sizes), np.array([sizes @ p.gram @ sizes / max(p.samples, 1) for p in pieces])
