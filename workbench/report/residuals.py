"""Numbers behind the figures: residuals of one axis against speed, position and frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from workbench.core import Comparison, RecordingError
from workbench.core.units import torque_unit

Signal = Literal["position", "torque_measured"]
Quantity = Literal["speed", "position", "load", "acceleration"]

#: What the residual of a torque is drawn against, and that of a position.
AGAINST: dict[str, tuple[Quantity, ...]] = {
    "torque": ("speed", "position", "load", "acceleration"),
    "position": ("speed", "position"),
}

#: The two signals that are compared, with their names in print.
SIGNALS: tuple[tuple[Signal, str], ...] = (("position", "position"), ("torque_measured", "torque"))

_BINS = 24
_FEWEST = 20


@dataclass(frozen=True)
class Binned:
    """Residual against a quantity: median and quartiles in bins, each of shape (bins,)."""

    centre: np.ndarray
    median: np.ndarray
    low: np.ndarray
    high: np.ndarray


def column(entry: RecordingError, axis: str) -> int | None:
    """Return the column of `axis` in a recording; None without such an axis."""
    return entry.recording.axes.index(axis) if axis in entry.recording.axes else None


def units(comparison: Comparison, axis: str) -> tuple[str, str]:
    """Return SI units of position and torque of an axis."""
    for entry in comparison.recordings:
        k = column(entry, axis)
        if k is not None and k < len(entry.recording.units):
            unit = entry.recording.units[k]
            return unit, torque_unit(unit)
    return "rad", "N m"


def has(entry: RecordingError, name: str) -> bool:
    """Return whether a signal was measured, simulated and compared.

    Where the loop is not known, the model follows the measured motion: its positions say nothing.
    """
    if entry.recording.get(name) is None or entry.simulated.get(name) is None:
        return False
    return not np.isnan(entry.position_rmse if name == "position" else entry.torque_rmse).all()


def noise(entry: RecordingError, name: str, k: int) -> float:
    """Return the root mean square error of a perfect model in column `k` of a signal."""
    values = entry.position_noise if name == "position" else entry.torque_noise
    return float(values[k]) if k < len(values) else float("nan")


def rmse(entry: RecordingError, name: str, k: int) -> float:
    """Return the root mean square residual of column `k` of a signal."""
    values = entry.position_rmse if name == "position" else entry.torque_rmse
    return float(values[k]) if k < len(values) else float("nan")


def speed(entry: RecordingError) -> np.ndarray:
    """Return the measured (or derived) velocity, shape (N, n)."""
    recording = entry.recording
    velocity = recording.get("velocity")
    return np.gradient(recording.position, recording.time, axis=0) if velocity is None else velocity


def worst_window(entry: RecordingError, axis: str) -> tuple[float, float]:
    """Return the stretch of time [s] to show first: about six swings where the residual is largest."""
    k, t = column(entry, axis), entry.recording.time
    whole = (float(t[0]), float(t[-1]))
    if k is None or len(t) < 100:
        return whole
    q = entry.recording.position[:, k]
    swings = np.count_nonzero(np.diff(q > np.nanmean(q)))
    length = max(0.5, 12.0 * entry.recording.duration / max(1, swings))
    if length > 0.5 * entry.recording.duration:
        return whole
    power = np.zeros(len(t))
    for name, _ in SIGNALS:
        if has(entry, name):
            size, r = rmse(entry, name, k), entry.residual(name)[:, k]
            power += np.nan_to_num((r / size) ** 2, posinf=0.0) if size > 0 else 0.0
    power[~np.asarray(entry.recording.valid, bool)] = 0.0
    width = round(length / entry.recording.period)
    total = np.concatenate([[0.0], np.cumsum(power)])
    start = int(np.argmax(total[width:] - total[:-width]))
    return float(t[start]), float(t[min(start + width, len(t) - 1)])


def _quantity(entry: RecordingError, against: Quantity, k: int) -> np.ndarray:
    """What a residual is drawn against, (N,); load and acceleration are the model's own, free of noise."""
    if against == "speed":
        return speed(entry)[:, k]
    if against == "position":
        return entry.recording.position[:, k]
    run = entry.simulated
    if against == "load":
        torque = run.get("torque_measured")
        return np.full(len(run), np.nan) if torque is None else torque[:, k]
    velocity = run.get("velocity")
    motion = np.gradient(run.position[:, k], run.period) if velocity is None else velocity[:, k]
    return np.gradient(motion, run.period)


def compared(entry: RecordingError, name: Signal) -> np.ndarray:
    """Return the residual (N, n) with NaN where nothing was measured, or where it was not compared.

    Along a measured motion, rows that do not count (its ends, standstill) leave exactly nothing.
    """
    residual = np.where(np.asarray(entry.recording.valid, bool)[:, None], entry.residual(name), np.nan)
    return residual if has(entry, "position") else np.where(residual == 0.0, np.nan, residual)


def binned(comparison: Comparison, axis: str, name: Signal, against: Quantity) -> Binned:
    """Return a signal's residual against speed, position, load or acceleration, all recordings together.

    Bins are of equal width over the middle 99 % of the quantity; those with few samples are left out.
    """
    xs, ys = [], []
    for entry in comparison.recordings:
        k = column(entry, axis)
        if k is None or not has(entry, name):
            continue
        x = _quantity(entry, against, k)
        y = compared(entry, name)[:, k]
        good = np.isfinite(x) & np.isfinite(y)
        xs.append(x[good])
        ys.append(y[good])
    empty = np.empty(0)
    x, y = (np.concatenate(xs), np.concatenate(ys)) if xs else (empty, empty)
    if len(x) < _FEWEST or np.ptp(x) == 0:
        return Binned(empty, empty, empty, empty)
    low, high = np.quantile(x, [0.005, 0.995])
    edges = np.linspace(low, high, _BINS + 1)
    which = np.digitize(x, edges) - 1
    rows = [
        (0.5 * (edges[b] + edges[b + 1]), *np.quantile(y[which == b], [0.5, 0.25, 0.75]))
        for b in range(_BINS)
        if np.count_nonzero(which == b) >= _FEWEST
    ]
    table = np.array(rows).reshape(-1, 4)
    return Binned(*table.T)


def spectrum(
    comparison: Comparison, axis: str, name: Signal, points: int = 160
) -> tuple[np.ndarray, np.ndarray]:
    """Return the amplitude spectral density of the residual, pooled over recordings.

    Returns:
        frequency [Hz] and density [unit/sqrt(Hz)], each of shape (at most `points`,), spaced
        logarithmically: the mean power in each band, by recording length.
    """
    from scipy import signal as sps  # slow to import, and only spectra need it

    parts = []
    for entry in comparison.recordings:
        k = column(entry, axis)
        if k is None or not has(entry, name) or len(entry.recording) < 64:
            continue
        y = entry.residual(name)[:, k]
        y = np.where(np.asarray(entry.recording.valid, bool) & np.isfinite(y), y, 0.0)
        length = min(len(y), 2 ** int(np.log2(max(64, len(y) // 6))))
        f, p = sps.welch(y, 1.0 / entry.recording.period, nperseg=length, detrend="constant")
        parts.append((f[1:], p[1:], float(len(y))))
    if not parts:
        return np.empty(0), np.empty(0)
    edges = np.geomspace(
        min(f[0] for f, *_ in parts) * 0.99, max(f[-1] for f, *_ in parts) * 1.001, points + 1
    )
    power, weight = np.zeros(points), np.zeros(points)
    for f, p, n in parts:
        band = np.clip(np.digitize(f, edges) - 1, 0, points - 1)
        power += n * np.bincount(band, p, points)
        weight += n * np.bincount(band, minlength=points)
    used = weight > 0
    centre = np.sqrt(edges[1:] * edges[:-1])
    return centre[used], np.sqrt(power[used] / weight[used])


def noise_density(comparison: Comparison, axis: str, name: Signal) -> float:
    """Return the amplitude spectral density [unit/sqrt(Hz)] of the noise floor as white noise."""
    power, total = 0.0, 0.0
    for entry in comparison.recordings:
        k = column(entry, axis)
        if k is None or not has(entry, name) or not np.isfinite(noise(entry, name, k)):
            continue
        power += len(entry.recording) * noise(entry, name, k) ** 2 * 2.0 * entry.recording.period
        total += len(entry.recording)
    return float(np.sqrt(power / total)) if total else float("nan")


def min_max(values: np.ndarray, bins: int) -> tuple[np.ndarray, float]:
    """Return `values` thinned for display: least and greatest of each of `bins` stretches, by time.

    Args:
        values: shape (N,).
        bins: most stretches wanted; with 2 * bins >= N nothing is thinned.

    Returns:
        The thinned values, shape (at most 2 * bins,), and the rows from one of them to the next.
    """
    if 2 * bins >= len(values):
        return values, 1.0
    length = -(-len(values) // bins)
    count = -(-len(values) // length)
    table = np.pad(values, (0, count * length - len(values)), mode="edge").reshape(count, length)
    order = np.sort(np.stack([table.argmin(axis=1), table.argmax(axis=1)], axis=1), axis=1)
    return np.take_along_axis(table, order, axis=1).ravel(), length / 2.0
