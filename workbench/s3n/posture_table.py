"""Smooth functions of a few angles as Chebyshev series over a box: cheap to evaluate and to differentiate.

A function that is analytic in the box has a series that converges geometrically (Trefethen, "Approximation
Theory and Approximation Practice", SIAM 2013, ch. 8), the faster the farther away its nearest singularity is.
So some hundred numbers are exact to rounding, and derivatives are series of the same kind.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.polynomial import chebyshev
from scipy.fft import dct

_FIRST, _MOST = 8, 96  # nodes an axis
_CACHED = 256  # postures evaluated at once: their polynomials stay in the processor's cache
_TAIL = 2  # so many of the last coefficients must be small


@dataclass(frozen=True)
class Series:
    """K functions over a box of n angles.

    Attributes:
        box: lower and upper end of each angle (n, 2).
        coefficients: of the products of Chebyshev polynomials (d_1, ..., d_n, K).
    """

    box: np.ndarray
    coefficients: np.ndarray

    def __call__(self, q: np.ndarray) -> np.ndarray:
        """Return values (N, K) at `q` (N, n), which has to lie in the box."""
        middle, half = self.box.mean(axis=1), (self.box[:, 1] - self.box[:, 0]) / 2.0
        angle = np.arccos(np.clip((q - middle) / half, -1.0, 1.0))
        flat = self.coefficients.reshape(-1, self.coefficients.shape[-1])
        out = np.empty((len(q), flat.shape[1]))
        for first in range(0, len(q), _CACHED):
            rows = slice(first, first + _CACHED)
            basis = np.ones((len(angle[rows]), 1))
            for i, size in enumerate(self.coefficients.shape[:-1]):
                own = np.cos(angle[rows, i, None] * np.arange(size))
                basis = (basis[:, :, None] * own[:, None, :]).reshape(len(own), -1)
            out[rows] = basis @ flat
        return out

    def slope(self, axis: int) -> Series:
        """Return the derivatives of all functions with respect to one angle."""
        half = (self.box[axis, 1] - self.box[axis, 0]) / 2.0
        found = chebyshev.chebder(self.coefficients, axis=axis) / half
        if found.shape[axis] == 0:
            found = np.zeros_like(self.coefficients)
        return Series(self.box, found)

    def part(self, functions: slice | Sequence[int]) -> Series:
        """Return some of the functions."""
        return Series(self.box, self.coefficients[..., functions])


def together(parts: Sequence[Series]) -> Series:
    """Return several series over one box as one series, so that their polynomials are evaluated once."""
    sizes = np.max([p.coefficients.shape[:-1] for p in parts], axis=0)
    padded = []
    for part in parts:
        own = part.coefficients.shape[:-1]
        after = [(0, int(most - size)) for most, size in zip(sizes, own, strict=True)]
        padded.append(np.pad(part.coefficients, [*after, (0, 0)]))
    return Series(parts[0].box, np.concatenate(padded, axis=-1))


def tabulate(
    function: Callable[[np.ndarray], np.ndarray],
    box: np.ndarray,
    tolerance: float,
    least: np.ndarray | float = 1e-300,
) -> Series | None:
    """Return the series of a function to the wanted accuracy; None if it does not converge.

    Args:
        function: from angles (N, n) to values (N, K).
        box: (n, 2).
        tolerance: size of the terms left out, relative to each function's largest value.
        least: what counts as each function's largest value where it has less (K,): one that is zero but for
            rounding has no series.

    Returns:
        None where the series does not converge: the function is singular in the box or close to it.
    """
    sizes = [_FIRST] * len(box)
    while True:
        series = _interpolate(function, box, sizes)
        size = np.abs(series.coefficients)
        scale = np.maximum(size.max(axis=tuple(range(len(box)))), least)
        # by axis: the largest coefficient of each degree over all others and functions, (d_i,)
        decay = [
            (size / scale).max(axis=tuple(a for a in range(len(box) + 1) if a != axis))
            for axis in range(len(box))
        ]
        long = [axis for axis, d in enumerate(decay) if d[-_TAIL:].max() > tolerance]
        if not long:
            kept = tuple(slice(0, int(np.flatnonzero(d > tolerance).max()) + 2) for d in decay)
            return Series(series.box, series.coefficients[kept])
        if any(sizes[axis] >= _MOST for axis in long):
            return None
        for axis in long:
            sizes[axis] = min(_MOST, int(1.5 * sizes[axis]))


def _interpolate(
    function: Callable[[np.ndarray], np.ndarray], box: np.ndarray, sizes: Sequence[int]
) -> Series:
    """Return the interpolation at the products of Chebyshev nodes."""
    nodes = [np.cos(np.pi * (np.arange(size) + 0.5) / size) for size in sizes]
    middle, half = box.mean(axis=1), (box[:, 1] - box[:, 0]) / 2.0
    # every other row backwards, so that each posture is a neighbour of the one before
    order = list(product(*(range(size) for size in sizes)))
    snake = sorted(order, key=lambda index: _snake(index, sizes))
    q = np.array([[nodes[i][k] for i, k in enumerate(index)] for index in snake])
    found = function(middle + half * q)
    values = np.empty((*sizes, found.shape[-1]))
    values[tuple(np.array(snake).T)] = found
    for axis, size in enumerate(sizes):
        values = np.asarray(dct(values, type=2, axis=axis)) / size
        values[(slice(None),) * axis + (0,)] /= 2.0
    return Series(np.array(box, float), values)


def _snake(index: tuple[int, ...], sizes: Sequence[int]) -> tuple[int, ...]:
    out: list[int] = []
    for k, size in zip(index, sizes, strict=True):
        out.append(size - 1 - k if sum(out) % 2 else k)
    return tuple(out)
