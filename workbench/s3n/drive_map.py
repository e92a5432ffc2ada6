"""Drive positions over the workspace as polynomials, for loops that have no closed chain at hand."""

from __future__ import annotations

from itertools import product

import numpy as np

from workbench.core import DriveMap, InputError
from workbench.models import Model

from .posture import PostureDependent

_DEGREES = {1: range(3, 16), 2: range(3, 13), 3: range(3, 8)}  # by number of drives
_SAMPLES = {1: 60, 2: 24, 3: 12}  # Chebyshev points an angle
_NEAR = 1e-6  # rad or m: below what encoders tell
_ALLOWED = 1e-3  # rad or m


def drive_map(model: Model, chain: PostureDependent | None = None) -> DriveMap | None:
    """Return drive positions over a model's limits to a microradian; None for a constant transmission.

    Args:
        model: names its closed chain and limits.
        chain: the mechanism, if it is at hand.

    Raises:
        InputError: no closed chain or limits, or positions that no short polynomial follows.
    """
    if not model.posture_dependent:
        return None
    chain = chain or PostureDependent(model)
    middle, half = chain.box.mean(axis=1), 0.5 * np.ptp(chain.box, axis=1)
    n = len(half)
    nodes = np.cos(np.pi * (np.arange(_SAMPLES[n]) + 0.5) / _SAMPLES[n])
    x = np.array(list(product(*[nodes] * n)))
    wanted = chain.at(middle + half * x).drives
    powers, factors, error = np.zeros((1, n), int), np.zeros((1, n)), np.inf
    for degree in _DEGREES[n]:
        powers = np.array([p for p in product(range(degree + 1), repeat=n) if sum(p) <= degree])
        columns = np.prod(x[:, None, :] ** powers, axis=2)
        factors = np.linalg.lstsq(columns, wanted, rcond=None)[0]
        error = float(np.abs(columns @ factors - wanted).max())
        if error < _NEAR:
            break
    if error > _ALLOWED:
        raise InputError(
            f"no short polynomial gives the drive positions of '{model.name}' (error {error:.2g})",
            file=model.source, column="closed_chain.limits", remedy="narrow the limits",
        )  # fmt: skip
    return DriveMap(middle, half, powers, np.ascontiguousarray(factors.T))
