"""Propagation of many small disturbances through linearised loops, all columns together, as machine code."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from workbench.core.compiled import compiled
from workbench.effects import follow


class Around(NamedTuple):
    """A linearised loop and its inputs: N rows, K substeps, n axes, v joints, C columns.

    Attributes:
        at: (R,) rows at which plant matrices are given; `transition`, `entry`: there, over a substep.
        torque: (N, n, C) on the mechanism; `commanded` (N, n, E) on the command of the columns `asking` (E,).
        gain, open: (N, n), behind the tap; False where the drive saturates.
        is_tick, stride, feedback, differentiates, period: as of `ControlLaw` and `Loop`.
        whole, fraction: delay in substeps; `lag` (n,) over the substep.
        at_command: whether the torque compared is the command.
        state: (2v, C) at the start.
    """

    at: np.ndarray
    transition: np.ndarray
    entry: np.ndarray
    torque: np.ndarray
    commanded: np.ndarray
    asking: np.ndarray
    gain: np.ndarray
    open: np.ndarray
    is_tick: np.ndarray
    stride: int
    feedback: np.ndarray
    differentiates: bool
    period: float
    whole: int
    fraction: float
    lag: np.ndarray
    at_command: bool
    state: np.ndarray


class Reading(NamedTuple):
    """Readings of small motions by the sensors.

    Attributes:
        map: (2n, 2v), state to position and rate that are read.
        follow: (n,), share of a step in which the rate follows, 1 without a lag.
        whole, part: delay in substeps; `remembers`: whether there is a lag or delay.
        own: (N, 2n, R), disturbances of the readings of the columns `columns` (R,).
    """

    map: np.ndarray
    follow: np.ndarray
    whole: int
    part: float
    remembers: bool
    own: np.ndarray
    columns: np.ndarray


@compiled()
def _times(matrix: np.ndarray, values: np.ndarray, out: np.ndarray) -> None:
    """Add to `out` (a, C) the product of (a, b) and (b, C), which are too narrow for a library's call."""
    for i in range(matrix.shape[0]):
        for j in range(matrix.shape[1]):
            factor = matrix[i, j]
            if factor != 0.0:
                for c in range(values.shape[1]):
                    out[i, c] += factor * values[j, c]


@compiled()
def _between(first: np.ndarray, second: np.ndarray, part: float, out: np.ndarray) -> None:
    """Fill `out` (a, b) with what lies between two matrices: the first at `part` 0, the second at 1."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = first[i, j] * (1.0 - part) + second[i, j] * part


@compiled(nogil=True)
def march(a: Around, r: Reading, fresh: np.ndarray, position: np.ndarray, tap: np.ndarray) -> None:
    """Fill the readings of drive position and compared torque, (N, n, C) each."""
    n, count, last = position.shape[1], position.shape[2], len(a.is_tick) - 1
    state, ring, late = a.state, a.whole + 2, r.whole + 2
    history, seen_before = np.zeros((ring, n, count)), np.zeros((late, 2 * n, count))
    command, asked, current = np.zeros((n, count)), np.zeros((n, count)), np.zeros((n, count))
    read, slow = np.zeros((n, count)), np.zeros((n, count))
    seen, drive = np.zeros((2 * n, count)), np.zeros((n, count))
    transition, entry, left = a.transition[0].copy(), a.entry[0].copy(), 0
    for k in range(last + 1):
        row, is_row = k // a.stride, k % a.stride == 0
        if is_row and len(a.at) > 1:
            if row >= a.at[left + 1] and left + 2 < len(a.at):
                left += 1
            part = (row - a.at[left]) / (a.at[left + 1] - a.at[left])
            _between(a.transition[left], a.transition[left + 1], part, transition)
            _between(a.entry[left], a.entry[left + 1], part, entry)
        if a.is_tick[k] or is_row or r.remembers:
            _look(r, state, k, row, seen, slow, seen_before)
            if is_row:
                position[row] = seen[:n]
            if a.is_tick[k]:
                if a.differentiates:
                    for i in range(n):
                        for c in range(count):
                            seen[n + i, c] = (seen[i, c] - read[i, c]) / a.period
                            read[i, c] = seen[i, c]
                command[:] = 0.0
                _times(a.feedback, seen, command)
        asked[:] = command
        for e in range(len(a.asking)):
            for i in range(n):
                asked[i, a.asking[e]] += a.commanded[row, i, e]
        history[k % ring] = asked
        newer, older = history[(k - a.whole) % ring], history[(k - a.whole - 1) % ring]
        for i in range(n):
            gain = a.gain[row, i]
            for c in range(count):
                mean = (1.0 - a.fraction) * newer[i, c] + a.fraction * older[i, c]
                at = older[i, c] if a.fraction > 0.0 else newer[i, c]
                if not a.open[row, i]:
                    at, mean = 0.0, 0.0
                if a.lag[i] > 0.0:
                    at = current[i, c]
                    current[i, c], mean = follow(at, mean, mean, 0.0, a.lag[i])
                if is_row:
                    tap[row, i, c] = asked[i, c] if a.at_command else at
                drive[i, c] = gain * mean + a.torque[row, i, c]
        fresh[:] = 0.0
        _times(transition, state, fresh)
        _times(entry, drive, fresh)
        state[:] = fresh


@compiled()
def _look(
    r: Reading, state: np.ndarray, k: int, row: int, seen: np.ndarray, slow: np.ndarray, before: np.ndarray
) -> None:
    """Position and rate (2n, C) that are read at substep `k`; called at every one where it remembers."""
    n, late = len(slow), len(before)
    seen[:] = 0.0
    _times(r.map, state, seen)
    if r.remembers:
        for i in range(n):
            for c in range(seen.shape[1]):
                slow[i, c] += r.follow[i] * (seen[n + i, c] - slow[i, c])
                seen[n + i, c] = slow[i, c]
        if k == 0:
            for m in range(late):
                before[m] = seen
        before[k % late] = seen
        newer, older = before[(k - r.whole) % late], before[(k - r.whole - 1) % late]
        for i in range(2 * n):
            for c in range(seen.shape[1]):
                seen[i, c] = (1.0 - r.part) * newer[i, c] + r.part * older[i, c]
    for e in range(len(r.columns)):
        for i in range(2 * n):
            seen[i, r.columns[e]] += r.own[row, i, e]
