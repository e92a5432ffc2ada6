"""Torque compared with acceleration: a wrong sign or swapped axes appear as an impossible inertia.

Above the frequencies of gravity, acceleration is ``M^-1 torque``, and M^-1 is symmetric and positive
definite: an axis' own torque pushes it forward, and what i does to j is what j does to i.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations

import numpy as np
import scipy

from workbench.core import Recording

from .lags import is_broad
from .result import Remark

_LOWEST_HZ, _HIGHEST_HZ = 1.0, 40.0
_SURE = 8.0  # standard deviations
_STRETCHES = 8  # of the recording; each is left out once
_EXPLAINED = 0.4  # of the acceleration, before anything is said
_OTHERS = " This check cannot judge slow axes; import with --model checks each axis by its weight."
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
    a = np.gradient(v, recording.period, axis=0)
    broad = np.array([is_broad(x) for x in tau.T])
    whole = _mobility(a, tau, drag)
    swapped, backward = _wrong(*whole, broad)
    for rows in _without_a_stretch(len(a)) if swapped or backward else ():
        swaps, signs = _wrong(*_mobility(a[rows], tau[rows], drag[rows]), broad)
        swapped, backward = swapped & swaps, backward & signs
    names = [recording.axes[i] for i in live]
    value = {"mobility": whole[0], "explained": whole[2]}
    remarks: list[Remark] = []
    for i, j in sorted(swapped):
        text = (
            f"'{names[i]}' accelerates with the torque of '{names[j]}' and the reverse: their columns "
            "are swapped."
        )
        remarks.append(Remark("problem", "swap", None, text, {**value, "axes": [names[i], names[j]]}))
    others = "" if len(backward) == len(names) else _OTHERS
    for i in sorted(backward):
        text = (
            f"'{names[i]}' accelerates against its measured torque: one of them has the wrong sign.{others}"
        )
        remarks.append(Remark("problem", "sign", names[i], text, value))
    return remarks


def _without_a_stretch(count: int) -> Iterator[np.ndarray]:
    """Rows that remain when a stretch is left out, each in turn: no single event may decide about a sign.

    The formula for the spread counts every row as one of its own. Where an arm moves slowly, what passes the
    filter is one short event, such as its sag at the start, and its rows are alike.
    """
    rows = np.arange(count)
    for stretch in np.array_split(rows, _STRETCHES):
        yield np.setdiff1d(rows, stretch, assume_unique=True)


def _wrong(
    mobility: np.ndarray, spread: np.ndarray, explained: np.ndarray, broad: np.ndarray
) -> tuple[set[tuple[int, int]], set[int]]:
    """Return pairs of axes that are swapped, and others that accelerate backwards."""
    n = len(mobility)
    swapped = {
        (i, j)
        for i, j in combinations(range(n), 2)
        if mobility[i, j] * mobility[j, i] > 9 * abs(mobility[i, i] * mobility[j, j])
        and min(explained[i], explained[j]) > _EXPLAINED
    }
    backward: set[int] = set()
    for i in set(range(n)) - {k for pair in swapped for k in pair}:
        # at one frequency a spring, or another axis that is driven at it, turns the phase of an inertia;
        # that two axes answer each other unlike, no spring does
        unlike = any(_unlike(mobility, spread, i, j) for j in range(n) if j != i)
        if mobility[i, i] < -_SURE * spread[i, i] and explained[i] > _EXPLAINED and (unlike or broad[i]):
            backward.add(i)
    return swapped, backward


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
