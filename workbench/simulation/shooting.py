"""A machine on the ground, run in many short windows, each from a state that was measured.

A long run of a machine that touches the ground parts from the recording with the first contact that comes a
little early. Short windows do not: multiple shooting, with starts that are measured and not fitted (H. G.
Bock, "Recent advances in parameter identification techniques for O.D.E.", 1983).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from workbench.effects import Plant, plate_columns

from .inverse import gain_along
from .native import mj_step
from .sense import reading, true_motion
from .world import World, push, world_of

_PROBE = 1e-6  # of the state and the torque: step of a difference


@dataclass(frozen=True)
class Windows:
    """Where windows begin, and under which torques they run; actuator coordinates.

    Attributes:
        starts: first row of each window, ascending, (W,); a window ends where the next begins, the last at N.
        position, velocity: of the drives as sensors show them, (N, n); only the rows of `starts` count.
        torque: at the tap, held over each row, (N, n).
        period: of the rows [s].
        stride: substeps in a row.
    """

    starts: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    torque: np.ndarray
    period: float
    stride: int


@dataclass(frozen=True)
class Shots:
    """What a model does in all windows, row by row; NaN before the first window, and where a run is lost.

    `position`, `velocity`: of the drives as sensors show them, (N, n). `force`: of the ground on the feet,
    world frame, (N, 3 F).
    """

    position: np.ndarray
    velocity: np.ndarray
    force: np.ndarray


def shoot(plant: Plant, windows: Windows) -> Shots:
    """Run a plant on its ground through all windows."""
    world, keep, states, shaft = _ready(plant, windows)
    rows = len(windows.torque)
    columns = plate_columns(plant.mujoco, plant.contacts)
    joints, speeds = np.full((2, rows, plant.mujoco.nv), np.nan)
    force = np.full((rows, len(columns)), np.nan)
    _shoot(
        world,
        keep.data.sensordata,
        columns,
        shaft,
        windows.stride,
        _edges(windows),
        states,
        joints,
        speeds,
        force,
    )
    seen = reading(plant.chain.sensors, joints @ plant.drives.T, speeds @ plant.drives.T)
    lost = ~(np.abs(speeds) < _TOO_FAST).all(axis=1)
    for values in (*seen, force):
        values[lost] = np.nan
    return Shots(*seen, force)


def sensitivities(
    plant: Plant, windows: Windows, extra: np.ndarray, readings: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Small changes of what a model does in all windows, linearised row by row.

    Args:
        plant, windows: as for `shoot`.
        extra: torque on the mechanism of C columns, (C, N, n).
        readings: change of the position and velocity that are read, (C, 2, N, n): where windows begin, the
            true state is another by as much.

    Returns:
        Change of the position read, (N, n, C), and of the force on the feet, (N, 3 F, C); zero before the
        first window.
    """
    world, keep, states, shaft = _ready(plant, windows)
    rows = len(windows.torque)
    columns = plate_columns(plant.mujoco, plant.contacts)
    lift = plant.lift @ np.linalg.inv(plant.model.transmission)
    moved = np.concatenate(
        [np.einsum("ji,cki->ckj", lift, -readings[:, k]) for k in range(2)],
        axis=-1,
    )
    push_of = np.ascontiguousarray(np.moveaxis(extra, 0, -1))
    starts_of = np.ascontiguousarray(np.moveaxis(moved, 0, -1))
    state = np.zeros((rows, 2 * plant.mujoco.nv, len(extra)))
    force = np.zeros((rows, len(columns), len(extra)))
    _spread(
        world, keep.data.sensordata, columns, shaft, windows.stride, _edges(windows), states,
        push_of, starts_of, state, force,
    )  # fmt: skip
    position = np.einsum("ij,kjc->kic", plant.drives, state[:, : plant.mujoco.nv])
    position[windows.starts[0] :] += np.moveaxis(readings[:, 0], 0, -1)[windows.starts[0] :]
    return np.nan_to_num(position), np.nan_to_num(force)


_TOO_FAST = 1e4  # rad/s or m/s


def _ready(plant: Plant, windows: Windows) -> tuple[World, object, np.ndarray, np.ndarray]:
    """World, what keeps it alive, states at the starts (W, 2, nv), and torque on the shafts (N, n)."""
    start = np.stack(
        true_motion(plant.chain.sensors, windows.position[windows.starts], windows.velocity[windows.starts]),
        axis=1,
    )
    states = plant.state_at(start @ np.linalg.inv(plant.model.transmission).T)
    world, keep = world_of(plant, start[0])
    gain = gain_along(plant.chain, windows.torque, windows.period)
    return world, keep, np.ascontiguousarray(states), gain * windows.torque + plant.chain.bias


def _edges(windows: Windows) -> np.ndarray:
    return np.append(windows.starts, len(windows.torque))


@njit(cache=True)
def _place(world: World, state: np.ndarray) -> None:
    """Put a world into a state (2, nv)."""
    world.position[:], world.speed[:] = state[0], state[1]
    world.laws.before[:] = state[1]


@njit(cache=True)
def _row(
    world: World, sensed: np.ndarray, columns: np.ndarray, shaft: np.ndarray, stride: int, force: np.ndarray
) -> None:
    """Go through one row under a held torque; `force` (3 F,) is what stands at its beginning."""
    for k in range(stride * world.substeps):
        push(world, shaft)
        mj_step(world.model, world.data)
        if k == 0:
            for i in range(len(columns)):
                force[i] = sensed[columns[i]]


@njit(cache=True, nogil=True)
def _shoot(
    world: World,
    sensed: np.ndarray,
    columns: np.ndarray,
    shaft: np.ndarray,
    stride: int,
    edges: np.ndarray,
    states: np.ndarray,
    position: np.ndarray,
    speed: np.ndarray,
    force: np.ndarray,
) -> None:
    """Fill motion of the joints (N, nv) and force (N, 3 F)."""
    for w in range(len(states)):
        _place(world, states[w])
        for k in range(edges[w], edges[w + 1]):
            position[k], speed[k] = world.position, world.speed
            _row(world, sensed, columns, shaft[k], stride, force[k])


@njit(cache=True, nogil=True)
def _spread(
    world: World,
    sensed: np.ndarray,
    columns: np.ndarray,
    shaft: np.ndarray,
    stride: int,
    edges: np.ndarray,
    states: np.ndarray,
    extra: np.ndarray,
    starts: np.ndarray,
    out: np.ndarray,
    force: np.ndarray,
) -> None:
    """Fill changes of the state (N, 2 nv, C) and the force (N, 3 F, C).

    `extra` (N, n, C) on the drives, `starts` (N, 2 nv, C) at the windows' beginnings.
    """
    joints, n, count, feet = len(world.speed), shaft.shape[1], out.shape[2], force.shape[1]
    size = 2 * joints
    slopes, touch = np.zeros((size, size + n)), np.zeros((feet, size + n))
    base, felt, other, pushed = np.zeros((2, joints)), np.zeros(feet), np.zeros(feet), np.zeros(n)
    after, now, end = np.zeros((2, joints)), np.zeros((2, joints)), np.zeros((2, joints))
    fresh = np.zeros((size, count))
    for w in range(len(states)):
        after[:] = states[w]
        for c in range(count):
            for i in range(size):
                fresh[i, c] = starts[edges[w], i, c]
        for k in range(edges[w], edges[w + 1]):
            now[:] = after
            out[k] = fresh
            _place(world, now)
            _row(world, sensed, columns, shaft[k], stride, felt)
            after[0], after[1] = world.position, world.speed
            for i in range(size + n):
                base[:], pushed[:] = now, shaft[k]
                if i < size:
                    base[i // joints, i % joints] += _PROBE
                else:
                    pushed[i - size] += _PROBE
                _place(world, base)
                _row(world, sensed, columns, pushed, stride, other)
                end[0], end[1] = world.position, world.speed
                for j in range(size):
                    slopes[j, i] = (end[j // joints, j % joints] - after[j // joints, j % joints]) / _PROBE
                for j in range(feet):
                    touch[j, i] = (other[j] - felt[j]) / _PROBE
            fresh[:] = 0.0
            for i in range(size + n):
                for c in range(count):
                    value = out[k, i, c] if i < size else extra[k, i - size, c]
                    if value != 0.0:
                        for j in range(size):
                            fresh[j, c] += slopes[j, i] * value
                        for j in range(feet):
                            force[k, j, c] += touch[j, i] * value
