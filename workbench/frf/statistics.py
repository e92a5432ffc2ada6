"""Distributions of complex normal estimates whose covariance was itself estimated from few residuals.

A covariance from `dof` complex residuals is a complex Wishart matrix over `dof`. Variances then scatter as
F distributions, not as chi-square ones: Pintelon and Schoukens 2012, ch. 2 and 12 (finite number of periods);
N. R. Goodman, "Statistical analysis based on a certain multivariate complex Gaussian distribution", Ann.
Math. Statist. 34, 1963.
"""

from __future__ import annotations

import numpy as np
import scipy


def real_halfwidth(variance: np.ndarray, dof: np.ndarray | float, level: float) -> np.ndarray:
    """Return half the interval that contains one real component of a complex number.

    Args:
        variance: estimated E |error|^2 of the complex number, any shape.
        dof: complex residuals behind it, broadcast against `variance`.
        level: probability of the interval, 0 to 1.
    """
    return np.sqrt(variance / 2) * scipy.stats.t.ppf(0.5 + 0.5 * level, 2 * np.asarray(dof))


def expected_distance(m: int, dof: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return mean and variance of Hotelling's T of a true model, each like `dof`; infinite for too few.

    T is d^H covariance^-1 d of m deviations d; `size`: rows of the matrix that the residuals estimated (fewer
    than m where the covariance is a Kronecker product with a known matrix). The mean of an inverted complex
    Wishart matrix is its true inverse times dof / (dof - size).
    """
    dof = np.asarray(dof, float)
    d1, d2 = 2.0 * m, 2.0 * (dof - size + 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = dof * m / (dof - size + 1)
        mean = np.where(d2 > 2, scale * d2 / (d2 - 2), np.inf)
        variance = scale**2 * 2 * d2**2 * (d1 + d2 - 2) / (d1 * (d2 - 2) ** 2 * (d2 - 4))
    return mean, np.where(d2 > 4, variance, np.inf)


def information_loss(dof: np.ndarray, size: int) -> np.ndarray:
    """Return the factor on the inverse of J^H Ĉ^-1 J that gives the covariance of weighted least squares.

    The weights scatter too, so that estimates scatter more than the plain inverse says: dof^2 over
    (dof - size)^2 - 1, from the first two moments of an inverted complex Wishart matrix (J. A. Tague and
    C. I. Caldwell, Multidim. Syst. Signal Process. 5, 1994). Infinite for too few residuals.
    """
    left = np.asarray(dof, float) - size
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(left > 1, np.asarray(dof, float) ** 2 / (left**2 - 1), np.inf)
