"""The residual torque along a motion, and the spring, gap or base that would explain it.

A closed loop is dear to simulate. Along the motion that the motors made no loop needs to be closed: whatever
hangs on them through a spring obeys an equation of its own, and the shape of an effect follows by least
squares on the torque alone, from several starts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from scipy.optimize import OptimizeResult, least_squares

from workbench.models import Model

from .motion import Motion

_BAND = 60.0  # Hz: above, acceleration is mostly noise
_STARTS = 3
_SHORT, _LONG = 15, 60  # evaluations from a start, and from the best of where these led
_APART = 0.3  # in the logarithm of a value: starts nearer to each other lead to one place


@dataclass(frozen=True)
class Lack:
    """Requirements of one motion on a spring.

    Attributes:
        step: of the rows [s].
        load: what passes through the spring when it is stiff, in the band, from its first value, (N,).
        column: torque on the drives per unit of the spring's answer, at some rows, (M, n).
        missing: what the drives lack in the band, at the same rows, (M, n); both zero where unknown.
        rows: which rows these are.
    """

    step: float
    load: np.ndarray
    column: np.ndarray
    missing: np.ndarray
    rows: slice

    @staticmethod
    def of(motion: Motion, model: Model, load: np.ndarray, column: np.ndarray) -> Lack:
        """Return them from the complete load (N,) and column (N, n)."""
        top = min(_BAND, 0.2 / motion.step)
        sos = scipy.signal.butter(2, top, fs=1.0 / motion.step, output="sos")
        rows = slice(None, None, max(1, round(0.2 / (top * motion.step))))
        missing = np.asarray(scipy.signal.sosfiltfilt(sos, lacking(motion, model) * motion.known, axis=0))
        missing *= motion.known
        return Lack(
            motion.step,
            np.asarray(scipy.signal.sosfiltfilt(sos, load - load[0])),
            (column * motion.known)[rows],
            missing[rows],
            rows,
        )

    def left(self, answer: np.ndarray) -> np.ndarray:
        """Return the torque still missing (M * n,) if the spring responds like (N,)."""
        return (self.missing - self.column * answer[self.rows, None]).ravel()


def lacking(motion: Motion, model: Model) -> np.ndarray:
    """Return the torque on the drives (N, n) that the model needs for the motion beyond the motors'
    torque.

    A torque is the mean over the step after its row, so that two of them lie about the row.
    """
    given = motion.torque.copy()
    given[1:] = 0.5 * (motion.torque[1:] + motion.torque[:-1])
    return (motion.required(model) - given) * motion.gain


def share_left(lacks: Sequence[Lack], left: np.ndarray) -> float:
    """Return the share of the squared residual torque that a remainder (M,) is."""
    return float(np.sum(left**2) / max(sum(float(np.sum(x.missing**2)) for x in lacks), 1e-300))


def refined(left: Callable[[np.ndarray], np.ndarray], starts: Sequence[Sequence[float]]) -> np.ndarray:
    """Return positive values that leave least, by least squares on their logarithms from the best of many
    starts.

    Args:
        left: values (k,) -> residual (M,).
        starts: values to begin with, (S, k).
    """
    tried = np.log(np.asarray(starts, float))
    order = np.argsort([float(np.sum(left(np.exp(x)) ** 2)) for x in tried])
    chosen: list[np.ndarray] = []
    for x in tried[order]:
        if len(chosen) < _STARTS and all(np.abs(x - other).max() > _APART for other in chosen):
            chosen.append(x)
    low, high = tried.min(axis=0) - 3.0, tried.max(axis=0) + 3.0

    def downhill(x: np.ndarray, most: int) -> OptimizeResult:
        return least_squares(lambda x: left(np.exp(x)), x, bounds=(low, high), diff_step=1e-3, max_nfev=most)

    best = min((downhill(x, _SHORT) for x in chosen), key=lambda found: found.cost)
    return np.exp(downhill(best.x, _LONG).x)
