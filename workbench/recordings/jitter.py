"""Jittering clocks: rows were sampled late, or only stamped late."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .clock import Clock

_FEW = 12  # rows that say nothing
_SAME_ROW = 0.9  # rows this far from their place on the uniform clock may have changed places [periods]


def settle_jitter(clock: Clock, smooth: Iterable[np.ndarray]) -> Clock:
    """Decide whether rows were sampled at their stamps, or one period apart.

    A sensor's rows can be predicted from their neighbours, the better the truer the times are.

    Args:
        clock: of a log whose stamps jitter.
        smooth: signals on the table's kept rows (K, k) that move without steps: positions, velocities.

    Returns:
        The same clock, or one whose rows are uniform where that predicts them better.
    """
    period, count = float(clock.time[1]), len(clock.logged)
    apart = np.maximum(1, np.round(np.diff(clock.logged) / period))
    # no row missing, or some, which is clear only where stamps are not late by half a row
    guesses = np.arange(count), np.concatenate([[0], np.cumsum(apart)]).astype(int)
    late = [clock.logged - period * row for row in guesses]
    worst, row = min(
        ((float(np.abs(x - np.median(x)).max()), row) for x, row in zip(late, guesses, strict=True)),
        key=lambda pair: pair[0],
    )
    if count < _FEW or worst > _SAME_ROW * period:
        return clock
    evidence = 0.0
    for signal in smooth:
        stamped, uniform = _surprise(clock.logged, signal), _surprise(row * period, signal)
        told = (stamped > 0) & (uniform > 0)
        evidence += float(np.log(stamped[told] / uniform[told]).sum())
    if evidence <= 0.0:
        return clock
    return Clock(np.arange(row[-1] + 1) * period, row * period, row, clock.kept, clock.jitter, clock.widest)


def _surprise(times: np.ndarray, signal: np.ndarray) -> np.ndarray:
    """Return the mean square error of a cubic prediction by four neighbouring rows, per column (k,).

    In units of the noise that such a prediction has, so that noise alone scores the same for any times.
    """
    x = np.stack([np.roll(times, -j)[2:-2] - times[2:-2] for j in (-2, -1, 1, 2)])
    weight = np.ones_like(x)
    for j in range(4):
        for m in range(4):
            if m != j:
                weight[j] *= -x[m] / (x[j] - x[m])
    y = np.stack([np.roll(signal, -j, axis=0)[2:-2] for j in (-2, -1, 1, 2)])
    missed = signal[2:-2] - np.einsum("jk,jkc->kc", weight, y)
    return np.mean(missed**2 / (1 + np.sum(weight**2, axis=0))[:, None], axis=0)
