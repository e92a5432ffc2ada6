"""Levels of noise that the rest of a model tells: no more than it has, and what no log holds.

Noise of a speed that a loop reads and its log leaves out becomes torque by the loop's damping, which shakes
the machine in a spectrum that the model's own loop shows. What a model misses follows the motion and adds to
some frequencies more than to others, so that the octave that needs least noise bounds it from above.
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
_PART = 1 / 3  # of the rest of an axis, in size: less than that may be anything
_LEAST = 1e-9  # of what is known: less is not there

Positions = Sequence[np.ndarray]


def reads_unlogged_speed(model: Model, recordings: Sequence[Recording]) -> bool:
    """Return whether loops read a sensor of speed that was not logged."""
    experiments = [prepare(r, model) for r in recordings if "velocity" in r.derived]
    return any(e.controller.kind in ("pd", "cascade_pv") and not differentiates(e) for e in experiments)


def noise_by_rest(
    noise: NoiseModel,
    recordings: Sequence[Recording],
    clean: Sequence[Recording],
    drawn: Sequence[Recording],
    moved: Callable[[NoiseModel], Positions] | None,
) -> NoiseModel:
    """Return noise levels: of positions at most a model's residual, and those of speeds that were not logged.

    Args:
        noise: as the recordings tell it by themselves.
        recordings, clean, drawn: as measured, and as the model runs without and with this noise.
        moved: what noise makes of the model's positions, one (N, n) a recording, for levels of noise; None
            where loops read no speed that was not logged.
    """
    rest, known, periods = _apart(recordings, clean), _apart(drawn, clean), [r.period for r in recordings]
    measured, least = _octaves(rest, periods), _octaves(known, periods)
    if not (np.isfinite(measured).all() and (least > 0.0).all()):
        return noise
    scatter = _scatter(rest, periods)[:, None]
    # trembling, or fast motion in a slow log, was taken for noise of the encoder, which is white
    share = measured[0] / least[0]
    share = np.where(share < 1.0 - 2.0 * np.sqrt(2.0) * scatter[0], share, 1.0)
    white = noise.levels.position_std
    first = noise if (share == 1.0).all() else _with(noise, position_std=np.sqrt(share) * white)
    if moved is None:
        return first
    rate = [np.nanstd(np.diff(x, axis=0), axis=0) / dt for x, dt in zip(rest, periods, strict=True)]
    level, made = np.median(rate, axis=0), np.zeros((len(rest), len(white)))
    for _ in range(_ROUNDS):
        noise = _with(noise, position_std=np.sqrt(share) * white)
        still, shaking = moved(noise), moved(_of_speed(level))
        alone = _octaves(still, periods)
        shaken = np.maximum(_octaves(shaking, periods), _LEAST * alone)
        doubt = scatter * np.hypot(measured, alone) / shaken
        times = np.maximum(_usual((measured - alone)[1:] / shaken[1:], doubt[1:]), 0.0)
        level = level * np.sqrt(times)
        share = np.clip((measured[0] - times * shaken[0]) / least[0], 0.0, 1.0)
        made = (_power(still) + times * _power(shaking)) / _power(rest)
    # where a model lacks much its rest has all frequencies, and what bounds noise is no noise
    believed = np.median(np.sqrt(made), axis=0) >= _PART
    white = np.where(believed, noise.levels.position_std, first.levels.position_std)
    level = np.where(believed, level, 0.0)
    return _with(noise, position_std=white, velocity_std=level) if believed.any() else first


def _apart(one: Sequence[Recording], other: Sequence[Recording]) -> list[np.ndarray]:
    """Positions of one less those of the other, (N, n) each, NaN on rows that do not count."""
    pairs = zip(one, other, strict=True)
    return [np.where((a.valid & b.valid)[:, None], a.position - b.position, np.nan) for a, b in pairs]


def _power(signals: Positions) -> np.ndarray:
    """Mean square of each, (R, n)."""
    return np.stack([np.nanmean(x**2, axis=0) for x in signals])


def _with(noise: NoiseModel, **levels: np.ndarray) -> NoiseModel:
    return NoiseModel(replace(noise.levels, **levels))


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
