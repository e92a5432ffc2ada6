"""What a machine is asked to do: smooth sums of sines about a posture, drawn anew for every case."""

from __future__ import annotations

import numpy as np

from .chain import Machine

#: Name, highest frequency [Hz], share of the machine's reach; the last is to judge by.
KINDS = (("slow", 0.35, 1.0), ("sweep", 3.0, 0.8), ("work", 1.2, 1.0), ("judge", 1.8, 0.9))
LOWEST, TONES, RISE = 0.06, 7, 0.5  # Hz, sines an axis, s


def reference(machine: Machine, seed: int, number: int, duration: float, tick: float) -> np.ndarray:
    """References of each tick (N, n) [rad or m] of `KINDS[number]`; starts at rest at the posture."""
    _, top, share = KINDS[number]
    draw = np.random.default_rng([seed, number, 409])
    t = np.arange(round(duration / tick)) * tick
    rise = np.clip(t / RISE, 0.0, 1.0)
    columns = []
    for middle, reach in zip(machine.posture, machine.reach, strict=True):
        tones = np.exp(draw.uniform(np.log(LOWEST), np.log(top), TONES))
        tones[-1] = top * draw.uniform(0.8, 1.0)
        weight = draw.uniform(0.5, 1.0, TONES) / (1.0 + tones / 0.5)
        curve = np.sin(2 * np.pi * (np.outer(t, tones) + draw.uniform(0, 1, TONES))) @ weight
        columns.append(middle + reach * share * curve / np.abs(curve).max() * rise * rise * (3 - 2 * rise))
    return np.round(np.column_stack(columns), 7)  # the same on machines whose sines differ in the last digit
