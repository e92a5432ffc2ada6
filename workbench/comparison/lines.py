"""Where a periodically excited run fails line by line: the response at each excited frequency.

What the excitation did is in its lines: there the simulated motion is held against the measured one as a
ratio, or the torque measured against the one that the model needs, where a run follows the measured motion.
So a resonance that the model lacks stands out where it is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import InputError, Recording, RecordingError, Share
from workbench.frf import lines_of
from workbench.simulation import scored_torque

_PERIODS = 3  # needed to tell a line from its noise
_WIDTH = 2.0 ** (1 / 6)  # a sixth of an octave
_SHOWN = 3


def line_shares(errors: Sequence[RecordingError]) -> tuple[Share, ...]:
    """Return the bands with most of the squared log ratio of simulated to measured motion, above that of the
    noise.

    Args:
        errors: recordings with their simulations; those with a stated period and no feedback count, or that
            follow the measured motion. Of their lines those that were excited.

    Returns:
        At most three shares of signal ``response`` an axis, largest first; empty where none applies.
    """
    shares: list[Share] = []
    for e in errors:
        r = e.recording
        period = r.excitation.period_s
        signal = {"none": "position", "unknown": scored_torque(r)}.get(r.controller.kind)
        if r.excitation.kind != "multisine" or not period or signal is None:
            continue
        rows = round(period / r.period)
        count = len(r) // rows - 1  # the first period holds the transient
        if count < _PERIODS or abs(rows * r.period - period) > 0.5 * r.period or not r.valid.all():
            continue
        try:
            excited = lines_of(r)
        except InputError:
            continue  # nothing says what was excited
        for i, axis in enumerate(r.axes):
            shares += _bands(r, e.simulated, signal, i, axis, rows, count, excited)
    return tuple(sorted(shares, key=lambda s: -s.share)[: _SHOWN * len(errors[0].recording.axes)])


def _bands(
    measured: Recording,
    simulated: Recording,
    signal: str,
    i: int,
    axis: str,
    rows: int,
    count: int,
    lines: np.ndarray,
) -> list[Share]:
    real, made = (_spectra(x.signals[signal][:, i], rows, count) for x in (measured, simulated))
    rate = 1.0 / (rows * measured.period)
    # what is up there is interpolation
    lines = lines[rate * lines <= (measured.excitation.f_max_hz or 0.4 / measured.period) * (1.0 + 1e-6)]
    mean, model = real.mean(axis=0)[lines], made.mean(axis=0)[lines]
    noise = (np.abs(real[:, lines] - mean) ** 2).sum(axis=0) / (count * (count - 1))
    clear = (np.abs(mean) ** 2 > 9.0 * noise) & (np.abs(model) > 0)
    if clear.sum() < 3:
        return []
    f, ratio = rate * lines[clear], np.log(model[clear] / mean[clear])
    excess = np.abs(ratio) ** 2 - noise[clear] / np.abs(mean[clear]) ** 2
    total = float(np.maximum(excess, 0.0).sum())
    edges = f[0] * _WIDTH ** np.arange(int(np.ceil(np.log(f[-1] / f[0]) / np.log(_WIDTH))) + 1)
    index = np.searchsorted(edges, f, side="right") - 1
    sums = np.bincount(index, weights=excess, minlength=len(edges))
    # per line, or a wide band would win by its width
    level = sums / np.maximum(np.bincount(index, minlength=len(edges)), 1)
    best = [k for k in np.argsort(-level) if sums[k] > 0][:_SHOWN]
    return [
        Share(axis, "response", "frequency", (edges[k], edges[k] * _WIDTH), "Hz", float(sums[k] / total))
        for k in best
    ]


def _spectra(position: np.ndarray, rows: int, count: int) -> np.ndarray:
    """Spectra of whole periods, (count, lines); differences first, so that a drift does not leak."""
    steps = np.diff(position)[-rows * count :].reshape(count, rows)
    slope = np.linspace(-0.5, 0.5, rows)
    steps = steps - steps.mean(axis=1, keepdims=True)
    steps = steps - np.outer(steps @ slope / (slope @ slope), slope)
    return np.fft.rfft(steps, axis=1)
