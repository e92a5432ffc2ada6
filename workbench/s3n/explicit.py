"""The paper's implementation: compensation torques from the preceding step, and when they are stable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import InputError, SimulationError
from workbench.effects import compile_plant
from workbench.models import Model

from .closed_forms import actuator_increment, injection_radius, parallel_inertia, to_serial
from .dynamics import reduced
from .variants import linkage_inertia, with_variant

_TABLE = np.linspace(-np.pi, np.pi, 721)  # knee angles of `Injection.radius`


@dataclass(frozen=True)
class Injection:
    """The parts that are simulated implicitly and injected (paper, Eqs. 25 to 27).

    Attributes:
        model: the Kin-Only model that is simulated.
        inertia: diagonal that goes into the armature, (n,) [kg m^2]: J2 E_h on the leg.
        damping: diagonal that goes into the joints' damping, (n,) [N m s/rad].
        coupling: off-diagonal of Delta M_act, (n, n): J2 E_x on the leg.
        drag: off-diagonal of Delta D_act, (n, n).
        linkage: M11, M12, M22 of Delta M_link in actuator coordinates.
        radius: spectral radius at the knee angles `_TABLE`.
    """

    model: Model
    inertia: np.ndarray
    damping: np.ndarray
    coupling: np.ndarray
    drag: np.ndarray
    linkage: tuple[float, float, float]
    radius: np.ndarray

    def residual(self, alpha: np.ndarray | float) -> np.ndarray:
        """Delta M_link(alpha), (..., 2, 2) [kg m^2]."""
        return to_serial(parallel_inertia(*self.linkage, alpha))

    def refuse(self, alpha: float) -> None:
        """Raise if the iteration diverges at a knee angle [rad].

        Raises:
            SimulationError: the spectral radius reaches one there; names it and the angle.
        """
        turned = (alpha + np.pi) % (2.0 * np.pi) - np.pi
        radius = float(np.interp(turned, _TABLE, self.radius))
        if radius >= 1.0:
            raise SimulationError(
                f"model '{self.model.name}', variant 'explicit': torques from the preceding step diverge, "
                f"spectral radius {radius:.3f} at a knee angle of {np.degrees(alpha):.1f} deg; "
                "use the implicit variant 's3n_full'"
            )


def injection(model: Model) -> Injection:
    """Return the increments of S3N split as in the paper: simulated implicitly, and injected.

    Raises:
        InputError: the model has no parallelogram with a linkage.
    """
    linkage, drives = linkage_inertia(model), model.actuators
    inertia, damping = actuator_increment(drives.inertia), actuator_increment(drives.damping)
    return Injection(
        with_variant(model, "kin_only"),
        np.diag(inertia).copy(),
        np.diag(damping).copy(),
        inertia - np.diag(np.diag(inertia)),
        damping - np.diag(np.diag(damping)),
        (linkage.M11, linkage.M12, linkage.M22),
        explicit_spectral_radius(model, _TABLE),
    )


def explicit_spectral_radius(model: Model, alpha: np.ndarray) -> np.ndarray:
    """Spectral radius of the iteration that injected torques make, at knee angles `alpha` (N,) [rad].

    The torques of the preceding step iterate the acceleration (paper, Eqs. 25 to 27) by
    A = (M_s + J2 E_h)^-1 (J2 E_x + Delta M_link). Where its radius reaches one the variant ``explicit``
    diverges, whatever the step.

    Raises:
        InputError: the model has no parallelogram with a linkage.
    """
    linkage = linkage_inertia(model)
    alpha = np.asarray(alpha, float)
    if alpha.ndim != 1:
        raise InputError(f"knee angles of shape {alpha.shape}", remedy="give (N,)")
    postures = np.stack([np.zeros_like(alpha), alpha], axis=1)
    serial = compile_plant(with_variant(model, "kin_only"))
    mass = reduced(serial, postures, np.zeros_like(postures)).mass
    increment = actuator_increment(model.actuators.inertia)
    residual = to_serial(parallel_inertia(linkage.M11, linkage.M12, linkage.M22, alpha))
    diagonal = np.diag(np.diag(increment))
    return injection_radius(mass + diagonal, increment - diagonal + residual)
