"""The part of the motion in which noise explains what laws leave; elsewhere acts something unknown.

A rough patch, a cable that pulls at one end or a blow acts at some positions or for some time. Laws that are
fitted to all rows follow it. On the half of the motion that they fit best they are what they are elsewhere
(least trimmed squares: P. Rousseeuw, J. Am. Statist. Assoc. 79(388), 1984, by concentration steps:
P. Rousseeuw and K. Van Driessen, Technometrics 41(3), 1999); a half is the most that nobody can take for the
exception.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.effects import effect_named

from ..data import Data
from ..fitting.normal_equations import normal, total
from ..hypothesis import Fit
from ..policy import POLICY
from ..screening.needed_torque import kept_rows, needing
from ..screening.propagation import propagate_sensitivities
from ..screening.torque_regression import Regression

_BINS = 20  # of each quantity, with as many rows in each
_STEPS = 20  # of concentration, far more than are ever needed


@dataclass(frozen=True, eq=False)
class Part:
    """Rows of each recording that are explained, (N,); numbers of the axes whose positions tell them."""

    rows: tuple[np.ndarray, ...]
    positions: frozenset[int]


def explained_part(found: Fit, regression: Regression, data: Data) -> Part | None:
    """The part of the motion, at least half of it, in which little more than noise is left by some laws.

    These are all that was found and all basic ones, as what is unknown may have hidden any.

    Args:
        found: with all effects that were selected, along the measured motion.
        regression: from which they were.
        data: of that motion.

    Returns:
        None where it is the whole motion, or less than half of it.
    """
    linearisation = regression.linearisation
    columns = [linearisation.total(a, a.values) for a in found.hypothesis.free]
    selected = len(columns)
    motions, names = needing(linearisation), {a.key for a in found.hypothesis.free}
    for entry in regression.entries:
        if effect_named(entry.key.effect).search.basic and entry.key not in names:
            columns += linearisation.columns(entry.key, entry.shape, motions)[0]
    acts = propagate_sensitivities([linearisation], [columns], data)[0]
    kept = [kept_rows(linearisation, i) for i in range(len(linearisation.runs))]
    laws = np.concatenate([part[own, 1] for part, own in zip(acts, kept, strict=True)])
    rest = np.concatenate(
        [
            data.residual(i, run)[own, 1] * data.weight[1]
            for i, (run, own) in enumerate(zip(found.simulated, kept, strict=True))
        ]
    )
    bins = {
        **{k: _bins([r.position[:, k] for r in data.recordings]) for k in range(rest.shape[1])},
        None: _bins(
            [
                np.arange(len(r)) + float(start)
                for r, start in zip(data.recordings, _starts(data), strict=True)
            ]
        ),
    }
    noise = data.least()[1] * data.weight[1] ** 2
    rows, positions = [np.ones(len(r), bool) for r in data.recordings], set[int]()
    for k in np.flatnonzero((noise > 0.0) & (np.mean(rest**2, axis=0) > POLICY.at_noise * noise)):
        good: dict[int | None, np.ndarray] = {}
        for quantity, own in bins.items():
            there = np.concatenate([b[r] for b, r in zip(own, kept, strict=True)])
            left = _explained(laws[:, k], laws[:, k, :selected].sum(axis=1) + rest[:, k], there)
            good[quantity] = left <= POLICY.near_noise * noise[k]
        quantity = max(good, key=lambda q: int(good[q].sum()))
        rows = [a & good[quantity][b] for a, b in zip(rows, bins[quantity], strict=True)]
        positions |= set() if quantity is None else {quantity}
    most = sum(len(r) for r in rows)
    if not 0.5 * most <= sum(int(r.sum()) for r in rows) < most:
        return None
    return Part(tuple(rows), frozenset(positions))


def _starts(data: Data) -> np.ndarray:
    """Of all rows, the numbers at which recordings start."""
    return np.cumsum([0, *(len(r) for r in data.recordings)])[:-1]


def _bins(values: Sequence[np.ndarray]) -> list[np.ndarray]:
    """The bin of each row of each recording, as many rows in each."""
    edges = np.quantile(np.concatenate(values), np.linspace(0.0, 1.0, _BINS + 1)[1:-1])
    return [np.searchsorted(edges, v) for v in values]


def _explained(laws: np.ndarray, torque: np.ndarray, bins: np.ndarray) -> np.ndarray:
    """Mean square in each bin that laws (M, E) and a constant leave, fitted to the best half of the bins."""
    columns = np.column_stack([laws[:, laws.any(axis=0)], np.ones(len(torque))])
    columns = columns / np.sqrt(np.mean(columns**2, axis=0))
    pieces = [normal(columns[bins == b], torque[bins == b]) for b in range(_BINS)]
    sizes, half = np.linalg.lstsq(columns, torque, rcond=None)[0], set[int]()
    for _ in range(_STEPS):
        left = np.array([p.after(sizes) / max(p.samples, 1) for p in pieces])
        best = set(np.argsort(left)[: _BINS // 2].tolist())
        if best == half:
            break
        half = best
        whole = total([pieces[b] for b in half])
        sizes = np.linalg.lstsq(whole.gram, whole.right, rcond=None)[0]
    return left
