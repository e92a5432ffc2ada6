"""The torque that a link needs, linear in its ten numbers: mass, first moment and inertia."""

from __future__ import annotations

import numpy as np

from .links import carrying, leaning, turning
from .motion import Motion

_MOMENTS = np.eye(3)
_INERTIAS = [
    (np.outer(a, b) + np.outer(b, a)) / (1.0 + (i == j))
    for i, a in enumerate(_MOMENTS)
    for j, b in enumerate(_MOMENTS)
    if i <= j
]


def link_regressor(motion: Motion, axis: int) -> np.ndarray:
    """Return the torque that the link of an axis needs for one unit more of each of its numbers, (10, N, n).

    Mass [kg], first moment along x, y and z [kg m], inertia about the origin xx, xy, xz, yy, yz and zz
    [kg m^2], in the frame of its body (W. Khalil and E. Dombre, Modeling, Identification and Control of
    Robots, Ch. 9).
    """
    link = motion.link(axis)
    return np.stack(
        [
            carrying(motion, link, np.zeros(3)),
            *(leaning(motion, link, way) for way in _MOMENTS),
            *(turning(motion, axis, tensor) for tensor in _INERTIAS),
        ]
    )
