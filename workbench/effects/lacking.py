"""The torque that a model lacks along a motion: chooses among shapes of an effect before a loop is closed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.signal import butter, sosfiltfilt

from workbench.models import Model

from .motion import Motion

_BAND = 60.0  # Hz: above, acceleration is mostly noise


def lacking(motion: Motion, model: Model) -> np.ndarray:
    """Torque on the drives (N, n) that the motion needs by the model beyond what the motors gave."""
    return (motion.required(model) - motion.torque) * motion.gain


def explains_most(motions: Sequence[Motion], model: Model, torques: Sequence[np.ndarray]) -> np.ndarray:
    """Numbers of the C candidates, the one first that leaves least of the lacking torque in a band.

    Args:
        motions: R of them.
        model: whose torque is lacking.
        torques: per motion what each candidate gives, (C, N, n).
    """
    left = np.zeros(len(torques[0]))
    for motion, given in zip(motions, torques, strict=True):
        missing = lacking(motion, model)
        sos = butter(2, min(_BAND, 0.2 / motion.step), fs=1.0 / motion.step, output="sos")
        # what is not needed at every row is taken at some
        part = slice(None, None, max(1, round(0.2 / (_BAND * motion.step))))
        left += np.sum(sosfiltfilt(sos, given - missing, axis=1)[:, part] ** 2, axis=(1, 2))
    return np.argsort(left)
