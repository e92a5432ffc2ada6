"""Turns as SDF and URDF write them."""

from __future__ import annotations

import warnings

import numpy as np
from scipy.spatial.transform import Rotation


def roll_pitch_yaw(turn: Rotation) -> np.ndarray:
    """Angles (3,) about the fixed axes x, y and z, in this order [rad]."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # where two angles are one, either is right
        return turn.as_euler("xyz")
