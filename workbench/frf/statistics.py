"""Distributions of complex normal estimates whose covariance was itself estimated from few residuals.

A covariance from `dof` complex residuals is a complex Wishart matrix over `dof`. Variances then scatter as
F distributions, not as chi-square ones: Pintelon and Schoukens 2012, ch. 2 and 12 (finite number of periods);
N. R. Goodman, "Statistical analysis based on a certain multivariate complex Gaussian distribution", Ann.
Math. Statist. 34, 1963.
"""

from __future__ import annotations

import numpy as np
import scipy


def entry_radius(variance: np.ndarray, dof: np.ndarray | float, level: float) -> np.ndarray:
    """Return the radius of the disc that contains one complex number with probability `level`.

    Args:
        variance: estimated E |error|^2, any shape.
        dof: complex residuals behind it, broadcast against `variance`.
        level: probability, 0 to 1.
    """
    return np.sqrt(variance * scipy.stats.f.ppf(level, 2, 2 * np.asarray(dof)))


def real_halfwidth(variance: np.ndarray, dof: np.ndarray | float, level: float) -> np.ndarray:
    """Return half the interval of one real component of a complex number; arguments as `entry_radius`."""
    return np.sqrt(variance / 2) * scipy.stats.t.ppf(0.5 + 0.5 * level, 2 * np.asarray(dof))


def distance(
    deviation: np.ndarray, covariance: np.ndarray, dof: np.ndarray | float, size: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return how far deviations are from zero, all entries together (Hotelling).

    Args:
        deviation: shape (F, m), complex.
        covariance: its estimated covariance, shape (F, m, m).
        dof: complex residuals behind the covariance, shape (F,) or a number.
        size: rows of the matrix that these residuals estimated: m, or fewer where the covariance is a
            Kronecker product with a known matrix.

    Returns:
        ``(T, p)``, each (F,): deviation^H covariance^-1 deviation, and the chance of a larger one. p is NaN
        where there are fewer residuals than `size`.
    """
    m = deviation.shape[1]
    with np.errstate(invalid="ignore", divide="ignore"):
        t = np.real(np.einsum("fi,fi->f", deviation.conj(), _solve(covariance, deviation)))
        left = np.asarray(dof, float) - size + 1
        p = scipy.stats.f.sf(t * left / (np.asarray(dof, float) * m), 2 * m, 2 * left)
    return t, np.where(left > 0, p, np.nan)


def expected_distance(m: int, dof: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return mean and variance of `distance`'s T for a true model, each like `dof`; infinite for too few.

    The mean of an inverted complex Wishart matrix is its true inverse times dof / (dof - size).
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


def _solve(covariance: np.ndarray, vector: np.ndarray) -> np.ndarray:
    return np.linalg.solve(covariance, vector[:, :, None])[:, :, 0]
