"""Drives and links linearised about a posture at rest that holding torques keep: small motions, and the FRF.

About (q0, 0) with the holding torque tau0 = -gravity(q0), small motions x = q - q0 obey

    (M(q0) + J_a) x'' + B_a x' + K x = tau - tau0,   K = -d gravity / d q;

the bias is quadratic in speed and drops out. J_a and B_a are the actuators' (paper, Eq. 7).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .closed_chain import ClosedChain

if TYPE_CHECKING:
    from control import StateSpace

_STEP = 1e-3  # [rad or m]; differences of fourth order: 1e-13 of truncation and as much of rounding
_STENCIL = ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))


@dataclass(frozen=True)
class LinearPlant:
    """``mass x'' + damping x' + stiffness x = tau - holding`` in drive coordinates.

    Attributes:
        posture: drive positions it is linearised about (n,) [rad or m].
        mass: links and rotors (n, n) [kg m^2].
        damping: of the drives (n, n) [N m s/rad].
        stiffness: of gravity (n, n) [N m/rad]; symmetric.
        holding: torque that keeps it at rest (n,) [N m].
    """

    posture: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    holding: np.ndarray

    def state_space(self) -> StateSpace:
        """From torques less `holding` (n,) to the states, positions less `posture` and speeds (2 n,)."""
        from control import StateSpace  # takes a second, and few need it

        n, none = len(self.posture), np.zeros_like(self.mass)
        lower = -np.linalg.solve(self.mass, np.hstack([self.stiffness, self.damping]))
        a = np.vstack([np.hstack([none, np.eye(n)]), lower])
        b = np.vstack([none, np.linalg.inv(self.mass)])
        return StateSpace(a, b, np.eye(2 * n), np.zeros((2 * n, n)))

    def frequency_response(self, omega: np.ndarray) -> np.ndarray:
        """Speed over torque (F, n, n) [rad/(s N m)] at `omega` (F,) [rad/s], not zero.

        Divided by i omega it is position over torque.
        """
        s = 1j * np.asarray(omega, float)[:, None, None]
        return np.linalg.inv(s * self.mass + self.damping + self.stiffness / s)


def linearise(
    chain: ClosedChain, q: np.ndarray, inertia: Sequence[float], damping: Sequence[float]
) -> LinearPlant:
    """Return the plant about drive positions `q`.

    Args:
        chain: the links.
        q: drive positions (n,) [rad or m].
        inertia: of each actuator at its output (n,) [kg m^2].
        damping: of each actuator at its output (n,) [N m s/rad].

    Raises:
        SimulationError: the loops cannot be closed at `q`, or are at a dead point.
    """
    q = np.array(q, float)
    rest = np.zeros(chain.size)
    at = chain.reduced_dynamics(q, rest)
    # a dead point where drives hardly move and joints do is as far off as one over the square of their ratio
    step = _STEP / max(1.0, float(np.abs(chain.serial_slope(q)[1]).max())) ** 2
    around = [
        [w * chain.reduced_dynamics(q + k * step * e, rest).gravity for k, w in _STENCIL]
        for e in np.eye(chain.size)
    ]
    stiffness = -np.sum(around, axis=1).T / step
    return LinearPlant(
        q,
        at.mass + np.diag(np.array(inertia, float)),
        np.diag(np.array(damping, float)),
        (stiffness + stiffness.T) / 2.0,
        -at.gravity,
    )
