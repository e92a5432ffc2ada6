"""Small matrices at every line: inverting the inputs, and covariances of what comes out."""

from __future__ import annotations

import numpy as np

from workbench.core import InputError, Recording

_SINGULAR = 1e-6  # inputs closer to dependent than this cannot be told apart


def solve_inputs(
    u: np.ndarray, driver: np.ndarray, frequency: np.ndarray, recording: Recording
) -> np.ndarray:
    """Return K with U K = I at every line: driver^H (U driver^H)^-1, (F, E, nu).

    Args:
        u, driver: spectra (F, nu, E).
        frequency: [Hz], for the error text.
        recording: of the error text.

    Raises:
        InputError: inputs that move together at some line.
    """
    back = np.conj(np.swapaxes(driver, 1, 2))
    cross = u @ back
    size = np.linalg.norm(u, axis=(1, 2)) * np.linalg.norm(driver, axis=(1, 2))
    least = np.linalg.svd(cross, compute_uv=False)[:, -1]
    bad = ~(least > _SINGULAR * size)
    if bad.any():
        where = frequency[int(np.argmax(bad))]
        raise InputError(
            f"at {where:.6g} Hz the inputs of the experiments are not independent", file=recording.source,
            remedy="excite every axis, in experiments that mix them differently (sum and difference)",
        )  # fmt: skip
    return back @ np.linalg.inv(cross)


def kronecker(rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return the covariance of a response whose error is V K: E[v v^H] (F, ny, ny) and K^T K* (F, nu, nu)."""
    ny, nu = rows.shape[1], columns.shape[1]
    return np.einsum("fik,fjl->fijkl", rows, columns).reshape(len(rows), ny * nu, ny * nu)


def output_noise(g: np.ndarray, scatter: np.ndarray, ny: int) -> np.ndarray:
    """Return the scatter of y - G u, (F, ny, ny): what the plant adds, without the loop's feedback."""
    nu = g.shape[2]
    yy, yu = scatter[:, :ny, :ny], scatter[:, :ny, ny : ny + nu]
    uu = scatter[:, ny : ny + nu, ny : ny + nu]
    back = np.conj(np.swapaxes(g, 1, 2))
    cross = yu @ back
    return yy - cross - np.conj(np.swapaxes(cross, 1, 2)) + g @ uu @ back
