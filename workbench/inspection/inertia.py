"""Torque compared with acceleration: a wrong sign or swapped axes appear as an impossible inertia.

Above the frequencies of gravity, acceleration is ``M^-1 torque``, and M^-1 is symmetric and positive
definite: an axis' own torque pushes it forward, and what i does to j is what j does to i.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np
import scipy

from workbench.core import Recording

from .lags import is_broad
from .result import Remark

_LOWEST_HZ, _HIGHEST_HZ = 1.0, 40.0
_SURE = 8.0  # standard deviations
_EXPLAINED = 0.4  # of the acceleration, before anything is said
_ALIKE = 3.0  # times: two couplings that friction and noise make unlike are still of one size


def remark_on_inertia(recording: Recording, held: np.ndarray) -> list[Remark]:
    """Check that each axis accelerates the way its measured torque pushes.

    Args:
        recording: what was measured.
        held: axes that stood still, shape (n,) bool; they are left out.
    """
    torque = recording.get("torque_measured")
    live = np.flatnonzero(~held)
    if torque is None or len(live) == 0 or len(recording) < 200:
        return []
    band = _band_pass(recording)
    v, tau = band(recording.velocity[:, live]), band(torque[:, live])
    drag = np.hstack([v, band(np.sign(recording.velocity[:, live]))])
    mobility, spread, explained = _mobility(np.gradient(v, recording.period, axis=0), tau, drag)
    names = [recording.axes[i] for i in live]
    value = {"mobility": mobility, "explained": explained}
    remarks: list[Remark] = []
    swapped: set[int] = set()
    for i, j in combinations(range(len(live)), 2):
        cross, straight = mobility[i, j] * mobility[j, i], mobility[i, i] * mobility[j, j]
        if cross > 9 * abs(straight) and min(explained[i], explained[j]) > _EXPLAINED:
            swapped |= {i, j}
            text = (
                f"'{names[i]}' accelerates with the torque of '{names[j]}' and the reverse: their columns "
                "are swapped."
            )
            remarks.append(Remark("problem", "swap", None, text, {**value, "axes": [names[i], names[j]]}))
    for i, axis in enumerate(names):
        backward = mobility[i, i] < -_SURE * spread[i, i] and explained[i] > _EXPLAINED
        # at one frequency a spring, or another axis that is driven at it, turns the phase of an inertia;
        # that two axes answer each other unlike, no spring does
        unlike = any(_unlike(mobility, spread, i, j) for j in range(len(live)) if j != i)
        if backward and i not in swapped and (unlike or is_broad(tau[:, i])):
            text = f"'{axis}' accelerates against its measured torque: one of them has the wrong sign."
            remarks.append(Remark("problem", "sign", axis, text, value))
    return remarks


def _unlike(mobility: np.ndarray, spread: np.ndarray, i: int, j: int) -> bool:
    """Whether the couplings between i and j have opposite signs: one of them has inconsistent signs."""
    there, back = mobility[j, i], mobility[i, j]
    plain = min(abs(there) / spread[j, i], abs(back) / spread[i, j]) > _SURE
    return plain and there * back < 0 and max(abs(there), abs(back)) < _ALIKE * min(abs(there), abs(back))


def _band_pass(recording: Recording) -> Callable[[np.ndarray], np.ndarray]:
    """Return columns (N, n) after a zero-phase filter above gravity and below the sensors' noise."""
    half = 0.5 / recording.period
    low, high = _LOWEST_HZ, min(_HIGHEST_HZ, 0.6 * half)
    sos = scipy.signal.butter(2, [min(low, 0.2 * high) / half, high / half], btype="band", output="sos")
    return lambda x: scipy.signal.sosfiltfilt(sos, x, axis=0)


def _mobility(a: np.ndarray, tau: np.ndarray, drag: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Fit ``a = M^-1 tau + D drag``: M^-1 (n, n), its deviations, the explained part of `a`."""
    columns = np.hstack([tau, drag])
    n = a.shape[1]
    found, *_ = np.linalg.lstsq(columns, a, rcond=None)
    rest = a - columns @ found
    # a torque that stays nil, of a joint without a drive, tells nothing
    inverse = np.where(columns.any(axis=0), np.diag(np.linalg.pinv(columns.T @ columns)), np.inf)
    inverse = np.maximum(inverse, 0.0)
    spread = np.sqrt(inverse[:, None] * rest.var(axis=0)[None, :])
    return found[:n].T, spread[:n].T, 1 - rest.var(axis=0) / a.var(axis=0)
