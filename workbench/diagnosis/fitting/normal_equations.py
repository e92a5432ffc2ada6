"""Normal equations of pieces of data, which can be added, subtracted and solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add

import numpy as np


@dataclass(frozen=True)
class Normal:
    """Normal equations of one piece of data: gram (C, C), right side (C,), squared residual, samples."""

    gram: np.ndarray
    right: np.ndarray
    square: float
    samples: int

    def __add__(self, other: Normal) -> Normal:
        return Normal(
            self.gram + other.gram,
            self.right + other.right,
            self.square + other.square,
            self.samples + other.samples,
        )

    def __sub__(self, part: Normal) -> Normal:
        return Normal(
            self.gram - part.gram,
            self.right - part.right,
            self.square - part.square,
            self.samples - part.samples,
        )

    def pick(self, index: Sequence[int]) -> Normal:
        """Return the equations of only these unknowns."""
        i = np.asarray(index, int)
        return Normal(self.gram[i[:, None], i], self.right[i], self.square, self.samples)

    def scaled(self, factors: np.ndarray) -> Normal:
        """Return the equations of unknowns whose columns are multiplied by factors (C,)."""
        return Normal(self.gram * np.outer(factors, factors), self.right * factors, self.square, self.samples)

    def mapped(self, matrix: np.ndarray) -> Normal:
        """Return the equations of unknowns (D,) of which the old ones are a linear map, `matrix` (C, D)."""
        return Normal(matrix.T @ self.gram @ matrix, matrix.T @ self.right, self.square, self.samples)

    def after(self, solution: np.ndarray) -> float:
        """Return the squared residual for given values of the unknowns."""
        return float(self.square - 2.0 * self.right @ solution + solution @ self.gram @ solution)


def normal(response: np.ndarray, residual: np.ndarray) -> Normal:
    """Return normal equations from weighted responses (N, 2, n, C) and weighted residuals (N, 2, n)."""
    x, y = response.reshape(residual.size, response.shape[-1]), residual.reshape(-1)
    return Normal(x.T @ x, x.T @ y, float(y @ y), len(residual))


def total(pieces: Sequence[Normal]) -> Normal:
    """Return normal equations of all pieces together."""
    return reduce(add, pieces)


def scaled_inverse(gram: np.ndarray) -> np.ndarray:
    """Return the pseudo-inverse (C, C) of a Gram matrix, whatever the sizes of its unknowns."""
    size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    sizes = np.outer(size, size)
    return np.linalg.pinv(gram / sizes, rcond=1e-10, hermitian=True) / sizes


def jackknife(each: np.ndarray) -> np.ndarray:
    """Return the standard deviation (C,) of what was solved with each of F pieces left out, (F, C)."""
    return np.sqrt((len(each) - 1) / len(each) * np.sum((each - each.mean(axis=0)) ** 2, axis=0))
