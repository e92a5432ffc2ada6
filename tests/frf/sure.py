"""How sure a response is, from its covariance: what the tests hold against a known truth."""

from __future__ import annotations

import numpy as np
from scipy import stats

from workbench.frf import Frf


def noise_std(frf: Frf) -> np.ndarray:
    """Deviation of every entry by noise alone, (F, ny, nu)."""
    return np.sqrt(np.einsum("fii->fi", frf.noise_covariance).real).reshape(frf.response.shape)


def radius(frf: Frf, level: float) -> np.ndarray:
    """Radius of the disc about each entry that holds the true one with probability `level`, (F, ny, nu)."""
    return frf.std * np.sqrt(stats.f.ppf(level, 2, 2 * frf.dof))[:, None, None]


def distance(frf: Frf, model: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Hotelling's squared distance of a model (F, ny, nu), and the chance of a larger one, (F,) each."""
    d = (frf.response - model).reshape(len(frf), -1)
    t = np.real(np.einsum("fi,fi->f", d.conj(), np.linalg.solve(frf.covariance, d[:, :, None])[:, :, 0]))
    left, m = frf.dof - frf.wishart_size + 1, d.shape[1]
    return t, stats.f.sf(t * left / (frf.dof * m), 2 * m, 2 * left)


def within(frf: Frf, low: float, high: float) -> Frf:
    """The lines of a band [Hz], both ends included."""
    return frf.kept((frf.frequency >= low) & (frf.frequency <= high))
