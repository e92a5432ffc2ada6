"""The shape of the residual torque: smooth functions of position, speed, load or time, or a tone.

None of them is a cause. Each is fitted to the residual torque and tested on blocks that were
left out, so that a function that only follows the noise removes nothing (P. Eilers and B. Marx, "Flexible
smoothing with B-splines and penalties", Statistical Science 11, 1996, the penalty chosen by these blocks).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import block_diag

from workbench.core import Shape
from workbench.core.units import torque_unit

from ..fitting.left_out import LeftOut, left_out
from ..fitting.normal_equations import normal, total
from ..policy import POLICY
from .missing_torque import Missing

_PIECES = 12  # polynomial pieces a quantity; of two quantities half as many each
_PENALTIES = np.logspace(-4, 4, 9)  # times the mean of the normal equations' diagonal
_BLOCK_S, _FOLDS = 1.0, 5
_GRID = 41
_FINER = 8  # frequencies a tone is looked for at, over those of the longest recording


@dataclass(frozen=True, eq=False)
class _Quantity:
    """A quantity (N,) that the torque may be a function of."""

    name: str
    unit: str
    values: np.ndarray


def shapes(missing: Missing, axis: str, *, of_two: bool = True) -> tuple[Shape, ...]:
    """Return the shapes that the residual torque of an axis follows; the one that removes most comes first.

    Args:
        missing: the residual torque.
        axis: name.
        of_two: whether functions of two positions are asked too.

    Returns:
        Functions of position, speed, load, time and the other axes' positions, of both positions, and a tone;
        those that remove nothing on blocks that were left out are not among them.
    """
    k = missing.axes.index(axis)
    unit = missing.units[k]
    singles = [
        _Quantity("position", unit, missing.position[:, k]),
        _Quantity("speed", f"{unit}/s", missing.speed[:, k]),
        _Quantity("load", torque_unit(unit), missing.load[:, k]),
        _Quantity("time", "s", missing.time),
    ]
    others = [
        _Quantity(f"the position of {name}", missing.units[j], missing.position[:, j])
        for j, name in enumerate(missing.axes)
        if j != k
    ]
    asked = [[q] for q in (*singles, *others)] + [[singles[0], q] for q in others if of_two]
    found = [_function(missing, k, q) for q in asked if all(_moves(x.values) for x in q)]
    if shows_tones(missing):
        found.append(tone_of(missing, axis))
    return tuple(sorted((s for s in found if s.share > 0.0), key=lambda s: -s.share))


def shows_tones(missing: Missing) -> bool:
    """Return whether recordings are long enough for a tone of a few cycles."""
    return len(missing.torque) * 0.4 / max(len(missing.start), 1) > POLICY.tone_cycles


def _moves(values: np.ndarray) -> bool:
    return bool(np.ptp(values) > 1e-9 * max(float(np.max(np.abs(values))), 1e-12))


def _function(missing: Missing, k: int, quantities: Sequence[_Quantity]) -> Shape:
    values = [q.values for q in quantities]
    basis, penalty = splines(values, values)
    torque = missing.torque[:, k]
    basis = _centred(basis, missing.start)
    fitted = _smooth(missing, basis, torque, penalty, _PENALTIES)
    grid = np.linspace(float(np.quantile(values[0], 0.005)), float(np.quantile(values[0], 0.995)), _GRID)
    there = splines(values, [grid, *(np.full(_GRID, np.median(v)) for v in values[1:])])[0]
    there = there - there.mean(axis=0)
    return _shape(missing, k, quantities, fitted, torque - basis @ fitted.whole, grid, there, values[0])


def tone_of(missing: Missing, axis: str) -> Shape:
    """Return the strongest frequency of an axis that all recordings share, each with its own phase."""
    k = missing.axes.index(axis)
    torque, step = missing.torque[:, k], missing.step
    parts = list(
        zip(np.split(torque, missing.start[1:]), np.split(missing.time, missing.start[1:]), strict=True)
    )
    size = _FINER * max(len(y) for y, _ in parts)
    power = sum(np.abs(np.fft.rfft(y, size)) ** 2 for y, _ in parts)
    frequencies = np.fft.rfftfreq(size, step)
    slow = frequencies < POLICY.tone_cycles / (size / _FINER * step)
    frequency = float(frequencies[int(np.argmax(np.where(slow, -1.0, power)))])
    turns = [
        np.stack([np.cos(2 * np.pi * frequency * t), np.sin(2 * np.pi * frequency * t)], 1) for _, t in parts
    ]
    basis = _centred(np.asarray(block_diag(*turns)), missing.start)
    fitted = _smooth(missing, basis, torque, np.eye(basis.shape[1]), np.array([1e-6]))
    grid = np.linspace(0.0, 1.0 / frequency, _GRID)
    there = np.zeros((_GRID, basis.shape[1]))
    longest = int(np.argmax([len(y) for y, _ in parts]))
    there[:, 2 * longest] = np.cos(2 * np.pi * frequency * grid)
    there[:, 2 * longest + 1] = np.sin(2 * np.pi * frequency * grid)
    cycle = np.where(
        np.repeat(range(len(parts)), [len(y) for y, _ in parts]) == longest, missing.time, np.nan
    )
    time = _Quantity("time", "s", missing.time)
    rest = torque - basis @ fitted.whole
    return _shape(missing, k, [time], fitted, rest, grid, there, cycle % (1.0 / frequency), frequency)


def _shape(
    missing: Missing,
    k: int,
    quantities: Sequence[_Quantity],
    fitted: LeftOut,
    rest: np.ndarray,
    grid: np.ndarray,
    there: np.ndarray,
    along: np.ndarray,
    frequency: float | None = None,
) -> Shape:
    """Return the function on its grid, with the mean of what it leaves around each value."""
    torque = missing.torque[:, k]
    moved = (fitted.each - fitted.whole) @ there.T
    known = np.isfinite(along)
    nearest = np.clip(np.rint((along[known] - grid[0]) / (grid[1] - grid[0])), 0, _GRID - 1).astype(int)
    count = np.bincount(nearest, minlength=_GRID)
    sums = np.bincount(nearest, rest[known], minlength=_GRID)
    return Shape(
        axis=missing.axes[k],
        quantities=tuple(q.name for q in quantities),
        units=tuple(q.unit for q in quantities),
        torque_unit=torque_unit(missing.units[k]),
        share=1.0 - fitted.left / max(float(torque @ torque), 1e-300),
        grid=grid,
        torque=there @ fitted.whole,
        std=np.sqrt((_FOLDS - 1) / _FOLDS * np.sum(moved**2, axis=0)),
        seen=np.where(count > 0, there @ fitted.whole + sums / np.maximum(count, 1), np.nan),
        frequency=frequency,
    )


def _smooth(
    missing: Missing, basis: np.ndarray, torque: np.ndarray, penalty: np.ndarray, weights: np.ndarray
) -> LeftOut:
    """A function's coefficients, with the penalty weight chosen relative to the size of its equations."""
    fold = (np.arange(len(torque)) // max(1, round(_BLOCK_S / missing.step))) % _FOLDS
    blocks = [normal(basis[fold == f], torque[fold == f]) for f in range(_FOLDS)]
    scale = float(np.mean(np.diag(total(blocks).gram))) + 1e-300
    return left_out(blocks, penalty, weights * scale)


def splines(values: Sequence[np.ndarray], at: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Products of cubic B-splines over each quantity's range, and their penalty on second differences."""
    pieces = _PIECES // len(values)
    bases, penalties = [], []
    for v, x in zip(values, at, strict=True):
        low, high = float(np.min(v)), float(np.max(v))
        knots = np.concatenate([[low] * 3, np.linspace(low, high, pieces + 1), [high] * 3])
        bases.append(BSpline.design_matrix(np.clip(x, low, high), knots, 3).toarray())
        second = np.diff(np.eye(bases[-1].shape[1]), 2, axis=0)
        penalties.append(second.T @ second)
    product = reduce(lambda a, b: (a[:, :, None] * b[:, None, :]).reshape(len(a), -1), bases)
    sizes = [b.shape[1] for b in bases]
    penalty = sum(
        reduce(np.kron, [p if i == j else np.eye(n) for j, n in enumerate(sizes)])
        for i, p in enumerate(penalties)
    )
    return product, penalty + 1e-6 * np.eye(product.shape[1])


def _centred(basis: np.ndarray, start: Sequence[int]) -> np.ndarray:
    """Return the values minus the mean of each recording, as for the torque."""
    return np.concatenate([p - p.mean(axis=0) for p in np.split(basis, start[1:])])
