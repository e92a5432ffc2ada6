"""Starts of swings in a motion without drives, and the number of rows from which the state there is
estimated.
"""

from __future__ import annotations

import numpy as np

from workbench.core import InputError, Recording
from workbench.recordings import NoiseLevels

from .starts import local_state

_UNDECIDED = 6  # swings that a motion is cut into that never turns back
_LEAST = 12  # rows of a swing
_NARROWEST, _NARROWER = 3, 0.7  # rows either side; from one width that is tried to the next
_SHOWN = 1.2  # times its noise, by which a sensor may be off the curve that is taken for the motion
_AWAY, _MOVES = 8.0, 20.0  # noise levels from where it was first: it moves; an axis that swings
_SMALLEST = 1e-6  # of an axis's range: what no sensor resolves


def swing_starts(recording: Recording, levels: NoiseLevels) -> tuple[np.ndarray, int]:
    """Return the first rows of swings (W,), about a period apart where motion is fastest, and the number of
    rows beside them.

    Dry friction turns where motion turns: in between, a polynomial follows it. What stands still first and
    moves then was held until then, and swings from there on.

    Args:
        recording: of motion that nothing drives.
        levels: noise of its sensors.

    Returns:
        The starts, and how many rows before and behind one say the state there.

    Raises:
        InputError: too few rows.
    """
    rows, position = len(recording), recording.position
    known = np.fmax(np.nan_to_num(levels.position_std), np.nan_to_num(levels.position_resolution))
    noise = np.maximum(known, _SMALLEST * np.ptp(position, axis=0) + 1e-12)
    released = int(np.argmax((np.abs(position - position[0]) > _AWAY * noise).any(axis=1)))
    swing = _period(position[released:], noise)
    held = 0 if released < swing // 10 else released + swing // 10
    if rows < held + swing // 4 + 2 * _LEAST:
        raise InputError(
            f"{rows - held} rows are too few for a free motion", file=recording.source,
            remedy="record for longer, or faster",
        )  # fmt: skip
    half = _half(recording, levels, noise, swing // 8, slice(held, None))
    first = held + half
    # a slope over the rows that say the state
    rise = position[2 * half :] - position[: -2 * half]
    speed = np.sum((rise / np.maximum(np.ptp(position, axis=0), 1e-300)) ** 2, axis=1)
    # among rows that stand, noise alone would choose, and the worst of it
    speed[(np.abs(rise) < _AWAY * np.sqrt(2.0) * noise).all(axis=1)] = 0.0

    def fastest(low: int, high: int) -> int:
        own = speed[low - half : high - half]
        return low + (int(np.argmax(own)) if own.any() else len(own) // 2)

    out = [fastest(first, first + max(1, swing // 2))]
    while (high := out[-1] + 5 * swing // 4 + 1) <= rows - max(half, _LEAST):
        out.append(fastest(out[-1] + 3 * swing // 4, high))
    return np.array(out), half


def _half(recording: Recording, levels: NoiseLevels, noise: np.ndarray, widest: int, moving: slice) -> int:
    """Most rows either side over which a polynomial leaves noise alone."""
    half = max(_NARROWEST, widest)
    while half > _NARROWEST:
        rest = (recording.position - local_state(recording, levels, half)[0])[moving][half:-half]
        if (np.sqrt(np.mean(rest**2, axis=0)) <= _SHOWN * noise).all():
            break
        half = max(_NARROWEST, int(_NARROWER * half))
    return half


def _period(position: np.ndarray, noise: np.ndarray) -> int:
    """Rows of one period of the axis that swings fastest; a share of all rows where none turns back."""
    rows = len(position)
    periods = [rows // _UNDECIDED]
    for own, level in zip(position.T, noise, strict=True):
        if own.std() < _MOVES * level:
            continue
        middle = np.flatnonzero(np.diff(np.sign(own - np.median(own))) != 0)
        # of crossings that noise makes several, one
        apart = np.diff(middle)
        apart = apart[apart > max(3, rows // 500)]
        if len(apart) >= 3:
            periods.append(2 * int(np.median(apart)))
    return int(np.clip(min(periods), _LEAST, max(rows // 2, _LEAST)))
