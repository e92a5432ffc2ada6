"""Many small disturbances sent round linearised loops, all columns side by side, as machine code."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from workbench.core.compiled import compiled
from workbench.effects import follow

from .cores import on_all_cores
from .linear import Loop


@dataclass(frozen=True)
class Disturbance:
    """C small changes along one run of N rows, actuator coordinates.

    Attributes:
        torque: on the mechanism, the mean over each row's step, (C, N, n).
        taps: number of a column -> change of the torque at the tap (N, n) that the motion does not cause,
            such as a delay's; its share that drives the mechanism stands in `torque`.
        commands: the same of the torque that the controller asks for, from each row on.
        readings: number of a column -> change of what sensors read, position and rate, (2, N, n). The run
            still starts with the reading that it starts with, and so somewhere else.
    """

    torque: np.ndarray
    taps: Mapping[int, np.ndarray] = field(default_factory=dict)
    commands: Mapping[int, np.ndarray] = field(default_factory=dict)
    readings: Mapping[int, np.ndarray] = field(default_factory=dict)


def propagate(
    loops: Sequence[Loop], disturbances: Sequence[Disturbance]
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Response of the position that is read and of the torque that is compared.

    Args:
        loops: one a run; any lengths and rates.
        disturbances: one a run; the same number of columns for all.

    Returns:
        Per run ``(position, torque)``, each (N, n, C), in the recording's coordinates.
    """
    return on_all_cores(_propagate, loops, disturbances)


def _propagate(loop: Loop, disturbance: Disturbance) -> tuple[np.ndarray, np.ndarray]:
    around = _around(loop, disturbance)
    rows, (n, _) = len(loop.gain), loop.drives.shape
    count = len(disturbance.torque)
    position, tap = np.zeros((2, rows, n, count))
    _march(around, _reading(loop, disturbance), np.zeros_like(around.state), position, tap)
    if not loop.at_command:
        for column, extra in disturbance.taps.items():
            tap[:, :, column] += extra
    return np.einsum("ij,kjc->kic", loop.read, position), np.einsum("ij,kjc->kic", loop.tap, tap)


class _Around(NamedTuple):
    """A loop and what enters it: N rows, K substeps, n axes, v joints, C columns.

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


class _Reading(NamedTuple):
    """What sensors make of small motions.

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


def _around(loop: Loop, disturbance: Disturbance) -> _Around:
    e, (n, v) = loop.experiment, loop.drives.shape
    count = len(disturbance.torque)
    delay = loop.delay / e.step
    whole = int(np.floor(delay + 1e-9))
    is_tick = np.zeros(e.substeps + 1, np.bool_)
    is_tick[e.ticks] = True
    asking, commanded = _some(disturbance.commands, len(loop.gain), n)
    return _Around(
        at=loop.rows,
        transition=np.ascontiguousarray(loop.transition),
        entry=np.ascontiguousarray(loop.entry),
        torque=np.ascontiguousarray(np.moveaxis(disturbance.torque, 0, -1)),
        commanded=commanded,
        asking=asking,
        gain=np.ascontiguousarray(loop.gain),
        open=np.ascontiguousarray(loop.open),
        is_tick=is_tick,
        stride=e.stride,
        feedback=np.ascontiguousarray(loop.feedback),
        differentiates=loop.differentiates,
        period=float(e.controller.period_s or e.recording.period),
        whole=whole,
        fraction=float(delay - whole) if delay - whole > 1e-9 else 0.0,
        lag=loop.lag / e.step,
        at_command=loop.at_command,
        state=_start(loop, disturbance, np.zeros((2 * v, count))),
    )


def _start(loop: Loop, disturbance: Disturbance, state: np.ndarray) -> np.ndarray:
    """State (2v, C) at which the run reads what it did without the disturbance."""
    back = np.kron(np.eye(2), loop.start / loop.scale)
    for column, values in disturbance.readings.items():
        state[:, column] = -back @ np.concatenate([values[0, 0], values[1, 0]])
    return state


def _reading(loop: Loop, disturbance: Disturbance) -> _Reading:
    h, n = loop.experiment.step, len(loop.drives)
    lag, late = loop.sensor_lag, loop.sensor_delay / h
    whole = int(np.floor(late + 1e-9))
    flat = {c: np.concatenate([*values], axis=1) for c, values in disturbance.readings.items()}
    columns, own = _some(flat, len(loop.gain), 2 * n)
    return _Reading(
        map=np.kron(np.eye(2), loop.scale[:, None] * loop.drives),
        follow=1.0 - np.where(lag > 0, np.exp(-h / np.where(lag > 0, lag, 1.0)), 0.0),
        whole=whole,
        part=float(late - whole) if late - whole > 1e-9 else 0.0,
        remembers=bool((lag > 0).any() or late > 0),
        own=own,
        columns=columns,
    )


def _some(values: Mapping[int, np.ndarray], rows: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the columns that have something (E,), and it, (N, width, E)."""
    columns = sorted(values)
    table = np.zeros((rows, width, len(columns)))
    for k, column in enumerate(columns):
        table[:, :, k] = values[column]
    return np.array(columns, np.intp), table


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
def _march(a: _Around, r: _Reading, fresh: np.ndarray, position: np.ndarray, tap: np.ndarray) -> None:
    """Fill the reading of the drives' position and the torque compared, (N, n, C) each."""
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
    r: _Reading,
    state: np.ndarray,
    k: int,
    row: int,
    seen: np.ndarray,
    slow: np.ndarray,
    before: np.ndarray,
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
