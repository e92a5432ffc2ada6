"""Removal of a tone that no effect explains, on every axis.

A tone moves the machine, so that what laws do has a part at its frequency, and a tone that is fitted to what
they leave takes of theirs. Fitted beside all of them it has its own size, and laws are what they are at all
other frequencies (R. Frisch and F. Waugh, Econometrica 1(4), 1933).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey, Recording
from workbench.simulation import scored_torque

from ..data import Data
from ..evidence.missing_torque import Missing
from ..evidence.shape import shows_tones, tone_of
from ..policy import POLICY
from .laws import Laws


@dataclass(frozen=True, eq=False)
class WithoutTones:
    """Recordings without their tones, and the laws that consist mostly of such a tone."""

    recordings: tuple[Recording, ...]
    tonal: frozenset[EffectKey]


def without_tones(laws: Laws, missing: Missing, data: Data) -> WithoutTones | None:
    """Return the recordings without the tone of each axis whose residual is mostly one tone.

    Args:
        laws: that were found along the motion, and basic ones.
        missing: the rest that those found leave.
        data: recordings along their motion.

    Returns:
        None where there is no such axis, or no torque was recorded.
    """
    names = [scored_torque(r) for r in data.recordings]
    torques = [r.signals[name].copy() for r, name in zip(data.recordings, names, strict=True) if name]
    tonal, found = set[EffectKey](), False
    for k in laws.above_noise if shows_tones(missing) else ():
        tone = tone_of(missing, missing.axes[k])
        if tone.frequency is None or tone.share < POLICY.unknown_most:
            continue
        found = True
        times = [r.time[rows] for r, rows in zip(data.recordings, laws.rows, strict=True)]
        waves = [_wave(tone.frequency, t) for t in times]
        sizes, overlap = _beside(laws.acts[:, k], laws.torque[:, k], waves)
        tonal |= {key for key, share in zip(laws.keys, overlap, strict=True) if share > POLICY.unknown_most}
        for torque, recording, size in zip(torques, data.recordings, sizes, strict=True):
            torque[:, k] -= _wave(tone.frequency, recording.time) @ size / data.weight[1, k]
    if not found or len(torques) < len(data.recordings):
        return None
    changed = zip(data.recordings, names, torques, strict=True)
    return WithoutTones(tuple(r.with_signals(**{str(n): t}) for r, n, t in changed), frozenset(tonal))


def _wave(frequency: float, time: np.ndarray) -> np.ndarray:
    """Return cosine and sine (N, 2)."""
    turn = 2.0 * np.pi * frequency * time
    return np.stack([np.cos(turn), np.sin(turn)], axis=1)


def _beside(laws: np.ndarray, torque: np.ndarray, waves: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return sizes of a wave in each recording (R, 2), fitted beside laws (M, E), and the share of each law
    that is wave.
    """
    ends = np.cumsum([len(w) for w in waves])[:-1]
    here, wanted = np.split(laws, ends), np.split(torque, ends)
    bases = [np.linalg.qr(w)[0] for w in waves]
    inside = sum(np.sum((b.T @ x) ** 2, axis=0) for b, x in zip(bases, here, strict=True))
    overlap = inside / np.maximum(np.sum(laws**2, axis=0), 1e-300)
    # the laws beside it, by what is at other frequencies
    outside = [x - b @ (b.T @ x) for b, x in zip(bases, here, strict=True)]
    scale = np.sqrt(np.sum(laws**2, axis=0))
    there = scale > 0.0
    sizes = np.zeros(laws.shape[1])
    columns = np.concatenate(outside)[:, there] / scale[there]
    sizes[there] = np.linalg.lstsq(columns, torque, rcond=1e-6)[0] / scale[there]
    left = [y - x @ sizes for x, y in zip(here, wanted, strict=True)]
    return np.array([np.linalg.lstsq(w, y, rcond=None)[0] for w, y in zip(waves, left, strict=True)]), overlap
