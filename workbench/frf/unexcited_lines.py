"""What is measured at lines where nothing was excited: noise, and nonlinear distortion.

What the input itself carries there (feedback, a nonlinear drive) is subtracted with the response between the
neighbouring lines. Pintelon and Schoukens 2012, ch. 4 (fast method, correction for the input's lines).
"""

from __future__ import annotations

import numpy as np

from .algebra import kronecker, output_noise
from .measure import Measured

_NEAR = 6  # silent lines pooled about an excited one


def distortion_covariance(
    m: Measured, g: np.ndarray, noise: np.ndarray, unit: np.ndarray, free: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return what odd distortion adds to the covariance of a response, from unexcited odd lines nearby.

    The experiments of a set drive a nonlinearity with the same signal up to a factor, so that their
    distortions may move together: the worst case is taken, as if one experiment said all.

    Args:
        m: spectra.
        g: response at the excited lines, (F, ny, nu).
        noise: covariance of the outputs' noise, one period, (F, ny, ny).
        unit: K^T K*, see `kronecker`, (F, nu, nu).
        free: residuals behind `noise`.

    Returns:
        ``(covariance, dof)``: what is to be added (F, ny nu, ny nu), and the complex residuals behind the
        sum, (F,), after Satterthwaite.
    """
    odd = m.listening[0]
    residual, quiet = residuals(m, g, odd)
    mean_periods = float(np.mean([s.periods for s in m.spectra]))
    own = np.einsum("eai,eaj->aij", residual, residual.conj()) / len(residual)
    own = mean_periods * own  # in units of one period, as `noise`
    near = np.argsort(np.abs(m.lines[:, None] - odd), axis=1, kind="stable")[:, :_NEAR]
    total = own[near].mean(axis=1)
    background = mean_periods * quiet[near].mean(axis=1)
    # what is there beyond noise, with no negative direction
    values, vectors = np.linalg.eigh(total - background)
    extra = np.einsum("fia,fa,fja->fij", vectors, np.maximum(values, 0.0), vectors.conj()) * g.shape[2]
    a, b = (np.einsum("fii->f", x).real for x in (noise, extra))
    lines = near.shape[1]
    with np.errstate(invalid="ignore", divide="ignore"):
        dof = (a + b) ** 2 / (a**2 / free + b**2 / lines)
    return kronecker(extra, unit), np.where(a + b > 0, dof, free)


def residuals(m: Measured, g: np.ndarray, lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return y - G u of each experiment's mean (E, A, ny) at silent lines, its covariance (A, ny, ny)."""
    ny, nu = g.shape[1:]
    there = m.at(lines)
    flat = g.reshape(len(g), -1)
    between = np.stack(
        [np.interp(lines, m.lines, c.real) + 1j * np.interp(lines, m.lines, c.imag) for c in flat.T], axis=1
    ).reshape(len(lines), ny, nu)
    residual = np.stack(
        [
            s.mean[there, :ny] - np.einsum("aij,aj->ai", between, s.mean[there, ny : ny + nu])
            for s in m.spectra
        ]
    )
    free = sum(s.free for s in m.spectra)
    noise = np.sum([s.free * output_noise(between, s.covariance[there], ny) for s in m.spectra], axis=0)
    return residual, noise / free * np.mean([1 / s.periods for s in m.spectra])
