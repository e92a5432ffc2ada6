"""Excitation: ranges, speeds, reversals and bands of every axis."""

from __future__ import annotations

import numpy as np
import scipy

from workbench.core import Recording
from workbench.recordings.noise import NoiseLevels
from workbench.recordings.velocity import derive_velocity

from .result import Excited, Remark

_SLOW = 0.05  # of the largest speed
_STILL = 1e-3  # of the largest range of any axis


def excited_axes(recording: Recording, noise: NoiseLevels) -> tuple[Excited, ...]:
    """Return the motion of each axis, from position and its derivative."""
    velocity = derive_velocity(recording.position, recording.period)
    ranges = np.ptp(recording.position, axis=0)
    step = np.nan_to_num(noise.position_resolution)
    held = (ranges <= 4 * step) | (ranges <= _STILL * ranges.max()) | (ranges == 0)
    return tuple(
        _axis(name, recording.position[:, i], velocity[:, i], recording.period, bool(held[i]))
        for i, name in enumerate(recording.axes)
    )


def remark_on_excitation(recording: Recording, excited: tuple[Excited, ...]) -> list[Remark]:
    """Return notes on held axes and on motion beyond what the row rate resolves."""
    remarks = [
        Remark(
            "note",
            "excitation",
            e.axis,
            f"Axis '{e.axis}' is held still, so it cannot show its own effects.",
        )
        for e in excited
        if e.held
    ]
    half = 0.5 / recording.period
    for e in excited:
        if not e.held and e.band_hz[1] > 0.6 * half:
            text = f"Axis '{e.axis}' moves up to {e.band_hz[1]:.3g} Hz, near half the row rate."
            remarks.append(Remark("warning", "excitation", e.axis, text, {"band_hz": e.band_hz}))
    return remarks


def _axis(name: str, q: np.ndarray, v: np.ndarray, period: float, held: bool) -> Excited:
    speed = np.abs(v)
    top = float(np.quantile(speed, 0.999))
    return Excited(
        axis=name,
        held=held,
        position_range=(float(q.min()), float(q.max())),
        speed_max=top,
        reversals=0 if held else _reversals(v, _SLOW * top),
        band_hz=(0.0, 0.0) if held else _band(v, period),
        low_speed_share=float(np.mean(speed < _SLOW * top)) if top > 0 else 1.0,
    )


def _reversals(v: np.ndarray, threshold: float) -> int:
    """Count changes of direction between speeds above the noise."""
    direction = np.sign(v[np.abs(v) > threshold])
    return int(np.count_nonzero(np.diff(direction)))


def _band(v: np.ndarray, period: float) -> tuple[float, float]:
    f, power = scipy.signal.welch(v, 1 / period, nperseg=min(len(v), max(256, round(4 / period))))
    above = np.clip(power - 2 * np.median(power[-len(power) // 4 :]), 0, None)
    share = np.cumsum(above) / max(above.sum(), 1e-300)
    return float(f[np.searchsorted(share, 0.01)]), float(f[np.searchsorted(share, 0.99)])
