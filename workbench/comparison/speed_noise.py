"""Noise of a speed that a loop reads and its log leaves out, told by how the machine trembles.

The loop's damping makes torque of it, which shakes the machine in a spectrum that the model's own loop shows.
What a model misses follows the motion and adds to some frequencies more than to others, so that the octave
that needs least noise bounds it from above.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from workbench.core import Recording
from workbench.models import Model
from workbench.recordings import NoiseLevels
from workbench.simulation import differentiates, prepare

from .noise import NoiseModel

_WINDOW, _FEWEST = 1.0, 64  # s, rows: resolves what a loop's bandwidth shapes
_ROUNDS = 2  # friction that sticks makes the machine's answer to noise other than linear
_LEAST = 1e-9  # of what is known: less is not there

Positions = Sequence[np.ndarray]


def reads_unlogged_speed(model: Model, recordings: Sequence[Recording], noise: NoiseModel) -> bool:
    """Whether loops read a sensor of speed of whose noise the recordings tell nothing."""
    if np.isfinite(noise.levels.velocity_std).any():
        return False
    experiments = [prepare(r, model) for r in recordings if "velocity" in r.derived]
    return any(e.controller.kind in ("pd", "cascade_pv") and not differentiates(e) for e in experiments)


def with_unlogged_speed(
    noise: NoiseModel,
    recordings: Sequence[Recording],
    clean: Sequence[Recording],
    noisy: Callable[[NoiseModel], Positions],
) -> NoiseModel:
    """Noise levels with those of the speed that loops read, as far as a model's rest shows it.

    Args:
        noise: of what was logged.
        recordings, clean: as measured and as the model runs without noise.
        noisy: what noise makes of the model's positions, one (N, n) a recording, for levels of noise.
    """
    periods = [r.period for r in recordings]
    pairs = list(zip(recordings, clean, strict=True))
    rest = [np.where(r.valid[:, None], r.position - c.position, np.nan) for r, c in pairs]
    rate = [np.nanstd(np.diff(x, axis=0), axis=0) / dt for x, dt in zip(rest, periods, strict=True)]
    level = np.median(rate, axis=0)
    if not np.isfinite(level).all():
        return noise
    measured, scatter = _octaves(rest, periods), _scatter(rest, periods)[:, None]
    white, least = noise.levels.position_std, _octaves(noisy(noise), periods)
    share = np.minimum(1.0, measured[0] / least[0])
    for _ in range(_ROUNDS):
        # trembling was taken for noise of the encoder too, of which the highest octave has most
        noise = NoiseModel(replace(noise.levels, position_std=np.sqrt(share) * white))
        known = _octaves(noisy(noise), periods)
        shaken = np.maximum(_octaves(noisy(_of_speed(level)), periods), _LEAST * known)
        doubt = scatter * np.hypot(measured, known) / shaken
        times = np.maximum(_usual((measured - known)[1:] / shaken[1:], doubt[1:]), 0.0)
        level = level * np.sqrt(times)
        share = np.clip((measured[0] - times * shaken[0]) / least[0], 0.0, 1.0)
    return NoiseModel(replace(noise.levels, velocity_std=level))


def _of_speed(level: np.ndarray) -> NoiseModel:
    """Noise of the speed alone: what an encoder rounds otherwise is no answer of the machine."""
    none = np.zeros_like(level)
    return NoiseModel(NoiseLevels(none, none, level, none))


def _usual(needed: np.ndarray, doubt: np.ndarray) -> np.ndarray:
    """Mean over the octaves (o, n) that agree with the one that allows least, by what each is worth, (n,).

    Where what is known is too much already, it was not white, and says nothing.
    """
    most = needed + 2.0 * doubt
    allowed = np.min(np.where(most > 0.0, most, np.inf), axis=0)
    worth = np.where((most > 0.0) & (needed - 2.0 * doubt <= allowed), doubt**-2.0, 0.0)
    return np.sum(worth * needed, axis=0) / np.maximum(np.sum(worth, axis=0), 1e-300)


def _with_speed(noise: NoiseModel, level: np.ndarray) -> NoiseModel:
    return NoiseModel(replace(noise.levels, velocity_std=level))


def _octaves(signals: Positions, periods: Sequence[float]) -> np.ndarray:
    """Power of the median window of all recordings, octave by octave from the highest, (octaves, n)."""
    powers = [_windows(x, dt) for x, dt in zip(signals, periods, strict=True)]
    count = min(p.shape[1] for p in powers)
    return np.median(np.concatenate([p[:, :count] for p in powers]), axis=0)


def _scatter(signals: Positions, periods: Sequence[float]) -> np.ndarray:
    """Share (octaves,) by which such a power scatters: of all lines of all windows half are independent."""
    windows = sum(len(_windows(x, dt)) for x, dt in zip(signals, periods, strict=True))
    lines = [-np.diff(_edges(_rows(x, dt))) for x, dt in zip(signals, periods, strict=True)]
    count = min(map(len, lines))
    return np.sqrt(2.0 / (windows * np.min([few[:count] for few in lines], axis=0)))


def _rows(signal: np.ndarray, period: float) -> int:
    """Of one window."""
    return min(max(_FEWEST, round(_WINDOW / period)), len(signal))


def _edges(rows: int) -> list[int]:
    """Lines of the spectrum between which octaves lie, from the highest."""
    edges = [rows // 2 + 1]
    while edges[-1] > 4:
        edges.append((edges[-1] + 1) // 2)
    return edges


def _windows(signal: np.ndarray, period: float) -> np.ndarray:
    """Power of each window that is whole, octave by octave from the highest, (windows, octaves, n)."""
    rows = _rows(signal, period)
    cut = signal[: len(signal) // rows * rows].reshape(-1, rows, signal.shape[1])
    cut = cut[np.isfinite(cut).all(axis=(1, 2))]
    power = np.abs(np.fft.rfft(cut * np.hanning(rows)[:, None], axis=1)) ** 2
    octaves = [power[:, low:high].sum(axis=1) for high, low in pairwise(_edges(rows))]
    return np.stack(octaves, axis=1)
