"""Inertia and weight of a body and of what is fixed to it, as one body of plain MJCF.

A body with gravity compensation has weight (1 - gravcomp) times its mass. Bodies without joints that effects
hung on a link, some with inertia and no weight, some with weight and next to no mass, become one body if the
first moment of the weights points along that of the masses; the force that is left over acts at the link's
joint, where its parent carries it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np

_ALONG = 1e-13  # sine of the angle that two first moments may have between them


@dataclass(frozen=True)
class Inertial:
    """Mass properties in a link's frame.

    Attributes:
        mass: [kg].
        moment: first moment of the masses (3,) [kg m].
        inertia: about the frame's origin (3, 3) [kg m^2].
        weight: mass that gravity acts on [kg].
        weight_moment: its first moment (3,) [kg m].
    """

    mass: float
    moment: np.ndarray
    inertia: np.ndarray
    weight: float
    weight_moment: np.ndarray

    def __add__(self, other: Inertial) -> Inertial:
        return Inertial(*(a + b for a, b in zip(vars(self).values(), vars(other).values(), strict=True)))

    @property
    def gravcomp(self) -> float:
        """Return the share of the weight that gravity compensation carries (`as_one` made it one number)."""
        return 1.0 - self.weight / self.mass if self.mass else 0.0

    @property
    def centre(self) -> np.ndarray:
        """Centre of mass (3,) [m]."""
        return self.moment / self.mass

    @property
    def central(self) -> np.ndarray:
        """Inertia about the centre of mass (3, 3) [kg m^2]."""
        c = self.centre
        return self.inertia - self.mass * (c @ c * np.eye(3) - np.outer(c, c))

    @property
    def is_body(self) -> bool:
        """Return whether a body can have these: positive, and no moment above the sum of the others."""
        if self.mass <= 0.0 or not np.isfinite(self.central).all():
            return False
        low, middle, high = np.linalg.eigvalsh(self.central)
        return bool(low > 0.0 and low + middle >= high)


def body_inertial(m: mujoco.MjModel, body: int, in_parent: bool) -> Inertial:
    """Return a compiled body's inertial, in its own frame or (without joints) in its parent's."""
    mass, share = float(m.body_mass[body]), 1.0 - float(m.body_gravcomp[body])
    turn, centre = _rotation(m.body_iquat[body]), m.body_ipos[body].copy()
    if in_parent:
        outer = _rotation(m.body_quat[body])
        turn, centre = outer @ turn, m.body_pos[body] + outer @ centre
    about = turn @ np.diag(m.body_inertia[body]) @ turn.T
    inertia = about + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return Inertial(mass, mass * centre, inertia, share * mass, share * mass * centre)


def as_one(total: Inertial) -> tuple[Inertial, float] | None:
    """Return the one body with this inertia and weights, and its gravity compensation; None if none.

    Returns:
        ``(body, left)``: and the weight [kg] that is left to act at the frame's origin; None where the two
        first moments point apart, so that no single body has both.
    """
    h, w = total.moment, total.weight_moment
    size = float(h @ h)
    if size == 0.0:
        return (total, 0.0) if not w.any() else None
    share = float(w @ h) / size
    if np.linalg.norm(w - share * h) > _ALONG * max(np.linalg.norm(w), np.linalg.norm(h)):
        return None
    if abs(share - 1.0) < _ALONG:
        share = 1.0
    weight = share * total.mass
    return replace(total, weight=weight, weight_moment=share * h), total.weight - weight


def about_a_fixed_axis(total: Inertial) -> Inertial | None:
    """Return an equivalent inertial with another centre, for a link that turns about a fixed axis.

    There only the inertia about the axis and the moment of the weights act; both stay. None where no body
    has such an inertia.
    """
    out = replace(total, moment=total.weight_moment, weight=total.mass)
    return out if out.is_body else None


def _rotation(quat: np.ndarray) -> np.ndarray:
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, np.array(quat, float))
    return matrix.reshape(3, 3)
