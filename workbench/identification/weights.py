"""What each line of a response counts for in a fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.core import InputError
from workbench.frf.response import Frf

_RESIDUALS = 20  # complex residuals wanted behind a covariance, beyond its rows
_ROUNDING = 1e-6  # part of a response's size to which nothing is ever measured
_NEAR = 7  # lines to each side whose residuals are pooled


def with_enough_residuals(frf: Frf) -> Frf:
    """Return the response with covariances pooled over as few neighbouring lines as make them usable.

    Raises:
        InputError: a covariance without any residual behind it.
    """
    least = float(np.min(frf.dof))
    if not (least > 0 and np.isfinite(frf.covariance).all() and np.isfinite(frf.response).all()):
        raise InputError("the response has no finite covariance", remedy="average two periods or more")
    wanted = frf.wishart_size + _RESIDUALS
    beside = float(np.min(frf.fresh))
    return frf.smoothed(int(np.ceil((wanted - least) / (2 * beside)))) if least < wanted else frf


def whitening(frf: Frf) -> np.ndarray:
    """Inverse Cholesky factor of each line's covariance, (F, m, m)."""
    size = np.sqrt(np.mean(np.abs(frf.response) ** 2, axis=(1, 2)))
    m = frf.covariance.shape[1]
    covariance = frf.covariance + (_ROUNDING * size)[:, None, None] ** 2 * np.eye(m)
    return np.linalg.inv(np.linalg.cholesky(covariance))


def weighted_by_rest(frf: Frf, rest: np.ndarray) -> Frf:
    """Return the response with a model's residual (F, ny, nu) as its covariance, where that is more."""
    d = rest.reshape(len(frf), -1)
    found = replace(
        frf,
        covariance=np.einsum("fi,fj->fij", d, d.conj()),
        dof=np.ones(len(frf)),
        fresh=np.ones(len(frf)),
        estimated="response",
    ).smoothed(_NEAR)
    noise = with_enough_residuals(frf).covariance
    # in units of the noise, what is left cannot be less than one in any direction
    whiten = whitening(replace(frf, covariance=noise))
    values, vectors = np.linalg.eigh(whiten @ found.covariance @ np.conj(np.swapaxes(whiten, 1, 2)))
    colour = np.linalg.inv(whiten) @ vectors
    covariance = (colour * np.maximum(values, 1.0)[:, None, :]) @ np.conj(np.swapaxes(colour, 1, 2))
    return replace(found, covariance=covariance)


def without_band(frf: Frf, band: int, bands: int) -> Frf:
    """Return the response without one of `bands` stretches of neighbouring lines."""
    edges = np.linspace(0, len(frf), bands + 1).round().astype(int)
    keep = np.ones(len(frf), bool)
    keep[edges[band] : edges[band + 1]] = False
    return frf.kept(keep)
