"""Random postures and speeds inside a mechanism's limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.models import Model, load_mjcf

_AROUND = 0.5  # rad or m
_LEFT = 1e-4  # of mass times speed squared: velocity terms that mean something
_SPEED = 10.0  # rad/s or m/s: a fast swing of a leg


@dataclass(frozen=True)
class States:
    """K states in serial coordinates: `position`, `velocity` (K, n) [rad, rad/s or m, m/s]."""

    position: np.ndarray
    velocity: np.ndarray

    def __len__(self) -> int:
        return len(self.position)


def joint_limits(model: Model, middle: np.ndarray) -> np.ndarray:
    """Lower and upper limit of each serial joint, (n, 2): of the closed chain, else of the MJCF.

    Where neither states a range, half a radian or metre to both sides of `middle` (n,).
    """
    if model.closed_chain is not None and model.closed_chain.limits:
        return np.array(model.closed_chain.limits, float)
    spec = load_mjcf(model.serial)
    stated = np.array([np.asarray(spec.joint(name).range, float) for name in model.joints])
    around = np.stack([middle - _AROUND, middle + _AROUND], axis=1)
    return np.where((stated[:, 0] < stated[:, 1])[:, None], stated, around)


def random_states(model: Model, count: int, seed: int, middle: np.ndarray) -> States:
    """States drawn uniformly inside the limits.

    Args:
        model: for the limits.
        count: number of states.
        seed: of the draw.
        middle: posture (n,) about which joints without limits are drawn.
    """
    generator = np.random.default_rng(seed)
    low, high = joint_limits(model, middle).T
    margin = 0.02 * (high - low)
    position = generator.uniform(low + margin, high - margin, (count, model.size))
    return States(position, generator.uniform(-_SPEED, _SPEED, (count, model.size)))


def moving(mass: np.ndarray, v: np.ndarray) -> float:
    """What velocity terms are held against where there are next to none, as of a mass on its axis.

    They are what is left of forces of the size of mass matrix (N, n, n) times speed (N, n) squared.
    """
    return _LEFT * float(np.abs(mass).max() * np.abs(v).max() ** 2)


def relative(difference: np.ndarray, reference: np.ndarray) -> float:
    """Largest difference over the largest entry of the reference, both (K, ...)."""
    scale = float(np.abs(reference).max(initial=0.0))
    worst = float(np.abs(difference).max(initial=0.0)) if np.isfinite(difference).all() else float("nan")
    return worst / scale if scale > 0 else worst
