"""Whether a mechanism's transmission is constant, as a parallelogram's is, or changes with the posture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import SimulationError

from .closed_chain import ClosedChain

_SEED = 11  # the same postures every time
_NONE = 1e-9  # largest change of an entry of J that counts as none
_AROUND = 0.5  # without limits: this far about the start posture [rad or m]


@dataclass(frozen=True)
class Transmission:
    """What J does over a workspace.

    Attributes:
        matrix: J (n, n): its mean over the workspace if it is constant, else its value at the start posture.
        deviation: largest difference of an entry from `matrix` over the postures tried.
        constant: the deviation is within the tolerance.
    """

    matrix: np.ndarray
    deviation: float
    constant: bool


def constant_transmission(chain: ClosedChain, samples: int = 60) -> Transmission:
    """J at random serial postures within the mechanism's limits (without limits: about its start posture).

    Args:
        chain: the mechanism.
        samples: number of postures; those that cannot be reached are left out.

    Raises:
        SimulationError: not one of the postures can be reached.
    """
    found: list[np.ndarray] = []
    for joints in sample_joints(chain, samples):
        try:
            found.append(chain.jacobian(joints))
        except SimulationError:
            continue
    if not found:
        raise SimulationError(f"{chain.mechanism.file}: no posture within the limits can be reached")
    values = np.array(found)
    mean = values.mean(axis=0)
    spread = float(np.abs(values - mean).max())
    if spread <= _NONE:
        # exact where exact is as good as what was computed: 1 rather than 0.9999999999999998
        rounded = np.round(mean, 12)
        within = np.abs(rounded - mean) <= spread + 4.0 * np.finfo(float).eps
        return Transmission(np.where(within, rounded, mean) + 0.0, spread, True)
    matrix = chain.jacobian(chain.start[1])
    return Transmission(matrix, float(np.abs(values - matrix).max()), False)


def sample_joints(chain: ClosedChain, samples: int) -> np.ndarray:
    """Random serial postures (samples, n) within the limits; without limits about the start posture."""
    start = chain.start[1]
    limits = np.array(chain.mechanism.limits or [(x - _AROUND, x + _AROUND) for x in start])
    return np.random.default_rng(_SEED).uniform(limits[:, 0], limits[:, 1], (samples, chain.size))
