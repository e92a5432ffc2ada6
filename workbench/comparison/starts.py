"""Starts of short windows, and the state there from least squares on neighbouring rows."""

from __future__ import annotations

from dataclasses import replace
from math import factorial

import numpy as np

from workbench.core import Recording
from workbench.recordings import NoiseLevels
from workbench.simulation import GROUND_TORQUE

_WINDOW_S, _SHORTEST = 0.03, 5  # of a window; rows
_HALF_S = 0.003  # about a start
_ORDER = 5  # of a polynomial that follows an eighth of a period either way


def half_rows(period: float) -> int:
    """Return the number of rows before and after a row from which its state is estimated."""
    return max(2, round(_HALF_S / period))


def local_state(
    recording: Recording, levels: NoiseLevels, half: int | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return position and velocity (N, n) at every row, and the standard deviation (n,) of the velocity from
    noise.

    A parabola through the positions, its slope through the measured velocities, each by its noise, over the
    rows about each; the first and last rows take those of the next that has enough. Over `half` rows before
    and behind, if given: then as high an order as these bear.
    """
    period, order = recording.period, 2
    if recording.timing.stepped:
        half, order = 0, 1  # of what steps made the rows are the states, and no curve runs between them
    elif half is None:
        half = half_rows(period)
    else:
        order = min(_ORDER, max(2, half - 1))
    position, velocity, spread = np.empty_like(recording.position), np.empty_like(recording.position), []
    measured = None if "velocity" in recording.derived else recording.get("velocity")
    t = np.arange(-half, half + 1) * period
    basis = np.stack([t**k / factorial(k) for k in range(order + 1)], axis=1)
    slopes = np.hstack([np.zeros((len(t), 1)), basis[:, :-1]])
    for i in range(position.shape[1]):
        noise = _known(levels.position_std[i], 1e-9)
        rows, values = basis / noise, [recording.position[:, i] / noise]
        if measured is not None and np.isfinite(levels.velocity_std[i]):
            noise = _known(levels.velocity_std[i], 1e-9)
            rows = np.concatenate([rows, slopes / noise])
            values.append(measured[:, i] / noise)
        weights = np.linalg.pinv(rows)
        spread.append(float(np.linalg.norm(weights[1])))
        parts = np.split(weights, len(values), axis=1)
        for out, k in ((position, 0), (velocity, 1)):
            # a correlation over the rows that are whole
            whole = sum(np.convolve(v, p[k][::-1], "valid") for v, p in zip(values, parts, strict=True))
            out[:, i] = np.pad(whole, half, mode="edge")
    return position, velocity, np.array(spread)


def _known(deviation: float, least: float) -> float:
    return max(float(deviation), least) if np.isfinite(deviation) else 1.0


def choose_starts(recording: Recording, force: np.ndarray | None) -> np.ndarray:
    """Return the first rows of windows (W,), about every 30 ms, each where the force on the feet changes
    least.

    Across a touchdown the velocity jumps, and no parabola follows it.

    Args:
        recording: with the rows.
        force: on the feet, (N, 3 F), or None where it was not measured.
    """
    half, rows = half_rows(recording.period), len(recording)
    length = max(_SHORTEST, round(_WINDOW_S / recording.period))
    nominal = np.arange(half, rows - half - length // 2, length)
    if force is None:
        return nominal
    around = np.lib.stride_tricks.sliding_window_view(force, 2 * half + 1, axis=0)
    change = np.pad(np.ptp(around, axis=-1).max(axis=1), half, mode="edge")
    reach = length // 4
    out = []
    for start in nominal:
        low = max(start - reach, half)
        own = change[low : min(start + reach + 1, rows - half)]
        # of rows as quiet as each other the one in its place
        away = np.abs(np.arange(low, low + len(own)) - start)
        out.append(low + int(np.argmin(own * (1.0 + 0.05 * away))))
    return np.unique(np.array(out, int))


def shaken(
    clean: Recording, quiet: Recording, still: Recording, seen: Recording, moved: Recording
) -> Recording:
    """Return a run with the effect of noise on the difference between a recording and a run from its own
    states.

    Args:
        clean: the run from the recording's states.
        quiet, still: the recording as smooth as these states, and the run from there.
        seen, moved: that as noisy sensors would have shown it, and the run from there.
    """

    def of(own: str, part: str) -> np.ndarray:
        run, smooth, there, shown, elsewhere = (
            getattr(r, part)[own] for r in (clean, quiet, still, seen, moved)
        )
        return run + shown - smooth - elsewhere + there

    signals = [name for name in ("position", GROUND_TORQUE) if name in quiet.signals]
    extra = [name for name in clean.extra if name in quiet.extra]
    return replace(
        clean.with_signals(**{name: of(name, "signals") for name in signals}),
        extra={name: of(name, "extra") for name in extra},
    )
