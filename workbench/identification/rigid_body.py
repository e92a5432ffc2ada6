"""The ten numbers of a rigid body, and what a body can have of them.

A body can exist if its pseudo-inertia, a symmetric matrix (4, 4) that is linear in the ten numbers, has no
negative eigenvalue (P. Wensing, S. Kim and J.-J. Slotine, IEEE Robotics and Automation Letters 3(1), 2018).
How far two bodies are apart is measured by one of them, so that neither units nor frames matter (T. Lee,
P. Wensing and F. Park, IEEE Trans. Robotics 36(1), 2020).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np

from workbench.effects import Link
from workbench.models import Inertial

#: The ten numbers of a body and their units, in the order of `effects.link_regressor`.
NUMBERS = {
    "mass": "kg",
    **{f"first_moment_{way}": "kg*m" for way in "xyz"},
    **{f"inertia_{pair}": "kg*m^2" for pair in ("xx", "xy", "xz", "yy", "yz", "zz")},
}
_SLIMMEST = 0.05  # of a link's size: a point or a rod without thickness is taken for a body this thick
_PAIRS = tuple(combinations_with_replacement(range(3), 2))  # xx, xy, xz, yy, yz, zz
_ENTRIES = tuple(combinations_with_replacement(range(4), 2))
#: Symmetric matrices (10, 4, 4) of length one, square to each other.
DIRECTIONS = np.stack(
    [
        np.where(i == j, 1.0, np.sqrt(0.5)) * np.maximum(np.outer(a, b), np.outer(b, a))
        for i, j in _ENTRIES
        for a, b in [(np.eye(4)[i], np.eye(4)[j])]
    ]
)


def numbers_of(inertial: Inertial) -> np.ndarray:
    """Return `NUMBERS` (10,) of a body: first moment and inertia are about its origin, in its frame."""
    mass, centre = inertial.mass, inertial.centre
    about = inertial.tensor + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return np.array([mass, *(mass * centre), *(about[pair] for pair in _PAIRS)])


def inertial_of(numbers: np.ndarray) -> Inertial:
    """Return mass, centre and inertia about it, for the ten numbers (10,) of a body."""
    mass, centre = float(numbers[0]), numbers[1:4] / numbers[0]
    about = np.zeros((3, 3))
    for (i, j), value in zip(_PAIRS, numbers[4:], strict=True):
        about[i, j] = about[j, i] = value
    return Inertial(mass, centre, about - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre)))


def pseudo_inertia(numbers: np.ndarray) -> np.ndarray:
    """Return the pseudo-inertia (4, 4) for the ten numbers (10,) of a body."""
    out = np.zeros((4, 4))
    for (i, j), value in zip(_PAIRS, numbers[4:], strict=True):
        out[i, j] = out[j, i] = -value
    out[range(3), range(3)] += 0.5 * (numbers[4] + numbers[7] + numbers[9])
    out[:3, 3] = out[3, :3] = numbers[1:4]
    out[3, 3] = numbers[0]
    return out


@dataclass(frozen=True, eq=False)
class Belief:
    """What a model file says of a link, as the measure of how far its numbers may be off.

    Attributes:
        numbers: of the link in the file, (10,).
        unit: a change of the ten numbers for each step along `DIRECTIONS`, (10, 10): by steps of one, a body
            becomes another one altogether, whatever its size.
        start: pseudo-inertia of the file's body, where the identity is that of a body of this size, (4, 4).
    """

    numbers: np.ndarray
    unit: np.ndarray
    start: np.ndarray

    @staticmethod
    def of(link: Link) -> Belief:
        """Return the belief in what a link's file says."""
        numbers = numbers_of(link.inertial)
        own = pseudo_inertia(numbers)
        outer = link.inertial.mass * np.outer(link.inertial.centre, link.inertial.centre)
        spread, axes = np.linalg.eigh(own[:3, :3] - outer)
        least = link.inertial.mass * (_SLIMMEST * link.size) ** 2
        thick = own.copy()
        thick[:3, :3] = axes @ np.diag(np.maximum(spread, least)) @ axes.T + outer
        root = np.linalg.cholesky(thick)
        inverse = np.linalg.inv(root)
        each = np.stack([pseudo_inertia(one).ravel() for one in np.eye(10)], axis=1)
        steps = np.stack([(root @ step @ root.T).ravel() for step in DIRECTIONS], axis=1)
        return Belief(numbers, np.linalg.lstsq(each, steps, rcond=None)[0], inverse @ own @ inverse.T)
