"""Small disturbances of a run, propagated through its linearised loop: prepares the inputs of `march`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from .cores import on_all_cores
from .experiment import whole_and_part
from .linear import Loop
from .march import Around, Reading, march


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
    """Return the responses of the position reading and the compared torque.

    Args:
        loops: one per run; any lengths and rates.
        disturbances: one per run; the same number of columns for all.

    Returns:
        Per run ``(position, torque)``, each (N, n, C), in the recording's coordinates.
    """
    return on_all_cores(_propagate, loops, disturbances)


def _propagate(loop: Loop, disturbance: Disturbance) -> tuple[np.ndarray, np.ndarray]:
    around = _around(loop, disturbance)
    rows, (n, _) = len(loop.gain), loop.drives.shape
    count = len(disturbance.torque)
    position, tap = np.zeros((2, rows, n, count))
    march(around, _reading(loop, disturbance), np.zeros_like(around.state), position, tap)
    if not loop.at_command:
        for column, extra in disturbance.taps.items():
            tap[:, :, column] += extra
    return np.einsum("ij,kjc->kic", loop.read, position), np.einsum("ij,kjc->kic", loop.tap, tap)


def _around(loop: Loop, disturbance: Disturbance) -> Around:
    e, (n, v) = loop.experiment, loop.drives.shape
    count = len(disturbance.torque)
    whole, fraction = whole_and_part(loop.delay / e.step)
    is_tick = np.zeros(e.substeps + 1, np.bool_)
    is_tick[e.ticks] = True
    asking, commanded = _some(disturbance.commands, len(loop.gain), n)
    return Around(
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
        fraction=fraction,
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


def _reading(loop: Loop, disturbance: Disturbance) -> Reading:
    h, n = loop.experiment.step, len(loop.drives)
    lag, late = loop.sensor_lag, loop.sensor_delay / h
    whole, part = whole_and_part(late)
    flat = {c: np.concatenate([*values], axis=1) for c, values in disturbance.readings.items()}
    columns, own = _some(flat, len(loop.gain), 2 * n)
    return Reading(
        map=np.kron(np.eye(2), loop.scale[:, None] * loop.drives),
        follow=1.0 - np.where(lag > 0, np.exp(-h / np.where(lag > 0, lag, 1.0)), 0.0),
        whole=whole,
        part=part,
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
