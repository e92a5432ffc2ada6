"""Sets of experiments that separate several inputs: how each experiment mixes the inputs.

With n inputs, n experiments give n equations a line. They are best conditioned, and the covariance of the
response smallest for a given amplitude, where the mixing matrix is unitary up to a factor and all its
entries have magnitude one. T. P. Dobrowiecki, J. Schoukens and P. Guillaume, "Optimized excitation signals
for MIMO frequency response function measurements", IEEE Trans. Instrum. Meas. 55, 2006; Pintelon and
Schoukens 2012, ch. 2 (multiple-input systems).
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.linalg import hadamard

from workbench.core import InputError

Mixing = Literal["orthogonal", "hadamard", "dft", "single"]


def mixing_matrix(inputs: int, kind: Mixing = "orthogonal") -> np.ndarray:
    """Return the complex factor of each input in each experiment.

    Two inputs give the paper's modes: the sum (both alike), then the difference (the second inverted).

    Args:
        inputs: number n of inputs.
        kind: ``"hadamard"`` (signs only; n a power of two), ``"dft"`` (phase rotations exp(j 2 pi e i / n),
            any n), ``"orthogonal"`` (the first where it exists, else the second), ``"single"`` (one input
            at a time).

    Returns:
        Shape (n, n): experiment, input.

    Raises:
        InputError: no input, or a Hadamard matrix that does not exist.
    """
    if inputs < 1:
        raise InputError(f"{inputs} inputs", column="axes", remedy="name at least one axis")
    power_of_two = inputs & (inputs - 1) == 0
    if kind == "single":
        return np.eye(inputs, dtype=complex)
    if kind == "hadamard" and not power_of_two:
        problem = f"there is no Hadamard set of {inputs} inputs here"
        raise InputError(problem, column="mixing", remedy="take 'dft' or 'orthogonal'")
    if kind == "dft" or not power_of_two:
        order = np.arange(inputs)
        return np.exp(2j * np.pi * np.outer(order, order) / inputs)
    return hadamard(inputs).astype(complex)


def mode_name(row: np.ndarray) -> Literal["sum", "difference", "single"] | None:
    """Return what a recording calls an experiment with these factors; None if it has no word for it."""
    if np.count_nonzero(row) == 1:
        return "single"
    if len(row) == 2 and np.allclose(row[1], row[0]):
        return "sum"
    if len(row) == 2 and np.allclose(row[1], -row[0]):
        return "difference"
    return None
