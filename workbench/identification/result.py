"""What identification returns: estimates with intervals, the response they come from, and the fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import Estimate
from workbench.core.shown import Shown
from workbench.frf import Frf
from workbench.models import Inertial

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


@dataclass(frozen=True)
class LinkNumber:
    """One number of a link: what the model says, what was found, and how far the data give it.

    Attributes:
        before, value: SI, in the frame of the link's body.
        std: of `value`, if the model may be wrong by the size of the body itself.
        identifiable: share of that variance that the data take away.
        unit: of these.
    """

    before: float
    value: float
    std: float
    identifiable: float
    unit: str


@dataclass(frozen=True)
class LinkFound:
    """A link with its new numbers.

    Attributes:
        axis: whose link it is; `joint`, `body`: what its file calls them.
        before, after: mass, centre of mass and inertia about it.
        numbers: ``mass``, ``first_moment_x`` ..., and ``inertia_xx`` ... about the body's origin.
    """

    axis: str
    joint: str
    body: str
    before: Inertial
    after: Inertial
    numbers: dict[str, LinkNumber]


@dataclass(frozen=True)
class AxisTorque:
    """Root mean square of the torque of an axis that a model does not explain, on data that were not fitted.

    Attributes:
        axis: its name; `unit`: N m, or N.
        before: of the model as it is.
        drives: with the best rotor, damping, dry friction and constant torque of each drive.
        after: with the links' new numbers too.
        noise: what noise leaves.
    """

    axis: str
    unit: str
    before: float
    drives: float
    after: float
    noise: float


@dataclass(frozen=True, repr=False)
class LinksIdentification(Shown):
    """The numbers of all links, fitted together.

    Attributes:
        model: its name.
        links: those that have a mass, by axis.
        torques: what stays unexplained, by axis.
        identifiable: how many combinations of all numbers the data give.
        held_out: whether `torques` are of held-out recordings; otherwise of blocks left out in turn.
        springs: axes whose springs were fitted beside, because data that were not fitted show them.
    """

    model: str
    links: tuple[LinkFound, ...]
    torques: tuple[AxisTorque, ...]
    identifiable: float
    held_out: bool
    springs: tuple[str, ...]

    _shown_by = "workbench.identification.notebook"

    @property
    def share(self) -> float:
        """Return the share of the squared torque above the noise, left beside the drives, that the links
        explain; each axis counts in units of its noise.
        """
        left = sum((t.drives / t.noise) ** 2 - 1.0 for t in self.torques)
        gone = sum((t.drives / t.noise) ** 2 - (t.after / t.noise) ** 2 for t in self.torques)
        return min(gone / left, 1.0) if left > 0.0 else 0.0
