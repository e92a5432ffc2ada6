"""What identification returns: estimates with intervals, the response they come from, and the fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import Estimate
from workbench.core.shown import Shown
from workbench.frf import Frf

from .fit import Fit


@dataclass(frozen=True, repr=False)
class ActuatorIdentification(Shown):
    """A drive on its own (paper, Table I).

    Attributes:
        inertia: N^2 J_m [kg m^2].
        damping: N^2 B_m [N m s/rad].
        delay: T_d, from command to torque [s].
        frf: the measured response, velocity over torque.
        fit: what it was fitted with, and whether that was enough.
    """

    inertia: Estimate
    damping: Estimate
    delay: Estimate
    frf: Frf
    fit: Fit

    _shown_by = "workbench.identification.notebook"


@dataclass(frozen=True, repr=False)
class LegIdentification(Shown):
    """A leg in actuator coordinates: M_p(alpha) = [[M11, M12 cos alpha], [., M22]] (paper, Eq. 14).

    Attributes:
        M11, M12, M22: total inertia, actuators included [kg m^2].
        covariance: of (M11, M12, M22), (3, 3).
        damping: of each drive [N m s/rad].
        delay: from command to torque [s].
        gravity: g1, g2 of the torque -g sin q, from the stiffness about the postures [N m].
        frfs: the measured responses, one per posture.
        fit: what they were fitted with, and whether that was enough.
    """

    M11: Estimate
    M12: Estimate
    M22: Estimate
    covariance: np.ndarray
    damping: tuple[Estimate, Estimate]
    delay: Estimate
    gravity: tuple[Estimate, Estimate]
    frfs: tuple[Frf, ...]
    fit: Fit

    _shown_by = "workbench.identification.notebook"

    @property
    def total(self) -> np.ndarray:
        """(M11, M12, M22)."""
        return np.array([self.M11.value, self.M12.value, self.M22.value])
