"""Velocity against the derivative of position: swapped columns, sign, unit, gear, clock offset."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from workbench.core import Recording
from workbench.recordings.velocity import derive_velocity

from .factors import name_factor
from .lags import ALIKE, alike, follow, swapped_columns
from .result import Remark

_SCALE = 0.03  # relative deviation of a factor from one that is reported
_RATES = (0.1, 1e6)  # Hz; a log of fewer or more rows has another fault than its clock
_OFFSET = 0.25  # clock offset in row periods that is reported
_SURE = 4.0  # deviations by which a filter's time has to differ from none
_UNLIKE = 0.1  # share of the position's slope that a filter may leave unexplained
_TURN = 0.03  # rad; an offset that turns the phase by less must stand out from noise all the more
_REACH = 50  # rows, the largest offset looked for


def remark_on_motion(recording: Recording, held: np.ndarray) -> list[Remark]:
    """Compare measured velocity with the derivative of position, axis by axis.

    Args:
        recording: what was measured.
        held: axes that stood still, shape (n,) bool; they are left out.
    """
    if "velocity" in recording.derived:
        return []
    v = recording.velocity
    slope = derive_velocity(recording.position, recording.period)
    moving = np.flatnonzero(~held)
    order, remarks = swapped_columns(
        recording, moving, lambda a, b: alike(v[:, a], slope[:, b]), "Position and velocity columns"
    )
    each = [_one_axis(recording.axes[i], v[:, i], slope[:, order[i]], recording.period) for i in moving]
    clock = _one_clock(each, recording.period)
    return [*remarks, *([clock] if clock else (r for axis in each for r in axis))]


def _one_clock(each: Sequence[Sequence[Remark]], period: float) -> Remark | None:
    """A remark if one factor on every axis suggests the clock they share rather than equal wrong gears."""
    wrong = [r for axis in each for r in axis if r.topic == "unit" and r.severity == "problem"]
    factors = np.abs([r.value["factor"] for r in wrong])
    named = any(r.value["meaning"] for r in wrong)
    if len(each) < 2 or len(wrong) < len(each) or named or np.ptp(factors) > _SCALE * factors.min():
        return None
    factor = float(np.median(factors))
    if not _RATES[0] < factor / period < _RATES[1]:
        return None
    rates = f"{factor / period:.4g} rows per second and not {1 / period:.4g}"
    text = (
        f"Velocity of every axis is {factor:.4g} times the derivative of its position: most likely the "
        f"clock is wrong ({rates}); otherwise the same gear ratio or unit is wrong on all axes."
    )
    return Remark("problem", "clock", None, text, {"factor": factor, "rate_hz": factor / period})


def _one_axis(axis: str, v: np.ndarray, slope: np.ndarray, period: float) -> list[Remark]:
    v, slope, band = _smooth(v, slope, period)
    lag = follow(slope, v, _REACH)[0]
    shifted = np.roll(slope, lag)[_REACH:-_REACH]
    seen, change = v[_REACH:-_REACH], np.gradient(shifted)
    # v(k) = factor * slope(k - lag - part): the part of a row is the slope's own first-order term
    (factor, cross), spread = _fit(np.column_stack([shifted, -change]), seen)
    if abs(abs(factor) - 1) > _SCALE and name_factor(float(factor)) is None:
        filtered = _filtered(axis, v, slope, band, period)
        if filtered is not None:
            return [filtered]
    if factor == 0 or abs(np.corrcoef(shifted, seen)[0, 1]) < ALIKE:
        text = f"Velocity of '{axis}' is not the derivative of its position."
        return [
            Remark("warning", "unit", axis, text, {"correlation": float(np.corrcoef(shifted, seen)[0, 1])})
        ]
    remarks = []
    if factor < 0:
        text = f"Velocity of '{axis}' has the wrong sign against its position."
        remarks.append(Remark("problem", "sign", axis, text, {"factor": float(factor)}))
    if abs(abs(factor) - 1) > _SCALE:
        meaning = name_factor(float(factor))
        cause = f"a mix-up of {meaning}" if meaning else "a gear ratio or a wrong unit"
        text = f"Velocity of '{axis}' is {abs(factor):.4g} times the derivative of its position: {cause}."
        remarks.append(Remark("problem", "unit", axis, text, {"factor": float(factor), "meaning": meaning}))
    offset, error = float(lag + cross / factor), float(spread[1] / abs(factor) / np.sqrt(band))
    turned = 2 * np.pi * band / (4 * period) * abs(offset) * period  # phase at the motion's top frequency
    told = 20 if turned < _TURN else 4
    if abs(offset) > max(_OFFSET, told * error):
        side = "after" if offset > 0 else "before"
        text = f"Velocity of '{axis}' comes {abs(offset) * period * 1e3:.3g} ms {side} its position."
        value = {"offset_s": offset * period, "std_s": error * period}
        remarks.append(Remark("warning", "clock", axis, text, value))
    if not remarks:
        text = f"Velocity of '{axis}' is the derivative of its position."
        remarks.append(
            Remark("ok", "unit", axis, text, {"factor": float(factor), "offset_s": offset * period})
        )
    return remarks


def _filtered(axis: str, v: np.ndarray, slope: np.ndarray, band: float, period: float) -> Remark | None:
    """Return a remark on a speed that a low-pass of first order made smaller, if its lag explains it.

    v + T dv/dt = slope, so that a gear or a unit shows in the first coefficient and a filter in the second.
    """
    columns = np.column_stack([v, np.gradient(v, period)])
    inside = slice(_REACH, -_REACH)
    (gain, time), spread = _fit(columns[inside], slope[inside])
    error = float(spread[1] / np.sqrt(band))
    left = np.sum((slope - columns @ [gain, time]) ** 2) / np.sum(slope**2)  # share of its power
    if abs(gain - 1) > _SCALE or time < _SURE * error or left > _UNLIKE:
        return None
    text = (
        f"Velocity of '{axis}' is filtered: it follows its position like a low-pass of {time * 1e3:.3g} ms."
    )
    return Remark("warning", "clock", axis, text, {"filter_s": float(time), "std_s": error})


def _smooth(v: np.ndarray, slope: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Return both after one zero-phase filter, so that only the common band is compared.

    The third value is the filter's band as a part of half the row rate: the share of rows that still
    count as independent.
    """
    power = np.abs(np.fft.rfft(slope - slope.mean())) ** 2
    share = np.cumsum(power) / power.sum()
    top = np.fft.rfftfreq(len(slope), period)[np.searchsorted(share, 0.95)]
    cut = min(2 * float(top) * 2 * period, 0.8)
    cut = max(cut, 0.004)
    sos = scipy.signal.butter(2, cut, output="sos")
    return scipy.signal.sosfiltfilt(sos, v), scipy.signal.sosfiltfilt(sos, slope), cut


def _fit(columns: np.ndarray, seen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return coefficients of a least-squares fit and their standard deviations."""
    found, *_ = np.linalg.lstsq(columns, seen, rcond=None)
    rest = seen - columns @ found
    variance = rest @ rest / max(1, len(seen) - columns.shape[1])
    return found, np.sqrt(variance * np.diag(np.linalg.pinv(columns.T @ columns)))
