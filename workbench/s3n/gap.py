"""The gap that a serial tree leaves: inertia and damping by term and posture (paper, Eqs. 5, 12, 13, 19)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from workbench.models import Model

from .closed_forms import actuator_increment
from .dynamics import variant_dynamics


@dataclass(frozen=True)
class InertiaGap:
    """The inertia that Kin-Only lacks over N knee angles, serial coordinates.

    Attributes:
        alpha: knee angles (N,) [rad].
        mass: variant -> mass matrix (N, 2, 2) [kg m^2].
        actuator: Delta M_act (2, 2), the same at every posture [kg m^2].
        linkage: Delta M_link (N, 2, 2) [kg m^2].
        damping: Delta D_act (2, 2) [N m s/rad].
        too_fast: by how much Kin-Only's acceleration exceeds the true one in the worst direction of torque,
            (N,): the largest eigenvalue of M_kin^-1 M_full, less one.
        worst: that direction of acceleration (N, 2), unit vectors of joint coordinates.
    """

    alpha: np.ndarray
    mass: dict[str, np.ndarray]
    actuator: np.ndarray
    linkage: np.ndarray
    damping: np.ndarray
    too_fast: np.ndarray
    worst: np.ndarray

    @property
    def actuator_share(self) -> np.ndarray:
        """Share of the gap that is the actuators', by Frobenius norm, (N,)."""
        actuator = np.linalg.norm(self.actuator)
        return actuator / (actuator + np.linalg.norm(self.linkage, axis=(1, 2)))


def inertia_gap(model: Model, alpha: np.ndarray) -> InertiaGap:
    """Return the gap of a parallelogram leg.

    Args:
        model: with its drives and linkage.
        alpha: knee angles (N,) [rad].

    Raises:
        InputError: the model has no parallelogram.
    """
    alpha = np.asarray(alpha, float)
    q = np.stack([np.zeros_like(alpha), alpha], axis=1)
    names = ("kin_only", "s3n_act", "s3n_full")
    mass = {name: variant_dynamics(model, name, q, np.zeros_like(q)).mass for name in names}
    too_fast, worst = np.empty(len(alpha)), np.empty((len(alpha), 2))
    for k, (kin, full) in enumerate(zip(mass["kin_only"], mass["s3n_full"], strict=True)):
        values, vectors = eigh(full, kin)
        too_fast[k] = values[-1] - 1.0
        worst[k] = vectors[:, -1] / np.linalg.norm(vectors[:, -1])
    return InertiaGap(
        alpha,
        mass,
        actuator_increment(np.array(model.actuators.inertia), model.transmission),
        mass["s3n_full"] - mass["s3n_act"],
        actuator_increment(np.array(model.actuators.damping), model.transmission),
        too_fast,
        worst,
    )
