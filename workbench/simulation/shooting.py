"""A machine on the ground, run in many short windows, each from a state that was measured.

A long run of a machine that touches the ground parts from the recording with the first contact that comes a
little early. Short windows do not: multiple shooting, with starts that are measured and not fitted (H. G.
Bock, "Recent advances in parameter identification techniques for O.D.E.", 1983).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.effects import Plant, plate_columns

from .inverse import gain_along
from .sense import reading, true_motion
from .windowed import differentiate, run_windows, travel
from .world import World, world_of


@dataclass(frozen=True)
class Windows:
    """Starts and torques of windows; actuator coordinates.

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
    """Motion of a model in all windows, row by row; NaN before the first window and where a run diverges.

    `position`, `velocity`: of the drives as sensors show them, (N, n). `force`: of the ground on the feet,
    world frame, (N, 3 F).
    """

    position: np.ndarray
    velocity: np.ndarray
    force: np.ndarray


def shoot(plant: Plant, windows: Windows) -> Shots:
    """Return the runs of a plant on its ground through all windows."""
    world, keep, states, shaft = _ready(plant, windows)
    rows = len(windows.torque)
    columns = plate_columns(plant.mujoco, plant.contacts)
    joints, speeds = np.full((2, rows, plant.mujoco.nv), np.nan)
    force = np.full((rows, len(columns)), np.nan)
    run_windows(
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


@dataclass(frozen=True)
class _Rows:
    """What the rows of some windows do to small changes of state (2 nv) and torque (n).

    `edges`: of the windows. `slopes`, `touch`: of the state after each row, and of the force in it,
    (rows, 2 nv or 3 F, 2 nv + n).
    """

    edges: np.ndarray
    slopes: np.ndarray
    touch: np.ndarray


@dataclass(frozen=True)
class Tangents:
    """Propagation of small changes through all windows of a plant, linearised row by row.

    What the rows do is worked out once and kept, where it is not too much.
    """

    plant: Plant
    windows: Windows

    def travel(self, extra: np.ndarray, readings: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the responses to C small changes.

        Args:
            extra: torque on the mechanism, (C, N, n).
            readings: change of the position and velocity that are read, (C, 2, N, n): where windows begin,
                the true state is another by as much.

        Returns:
            Change of the position read, (N, n, C), and of the force on the feet, (N, 3 F, C); zero before
            the first window.
        """
        plant, rows = self.plant, len(self.windows.torque)
        lift = plant.lift @ np.linalg.inv(plant.model.transmission)
        moved = np.concatenate([np.einsum("ji,cki->ckj", lift, -readings[:, k]) for k in range(2)], axis=-1)
        push_of = np.ascontiguousarray(np.moveaxis(extra, 0, -1))
        starts_of = np.ascontiguousarray(np.moveaxis(moved, 0, -1))
        state = np.zeros((rows, 2 * plant.mujoco.nv, len(extra)))
        force = np.zeros((rows, 3 * len(plant.contacts), len(extra)))
        for part in self._parts():
            travel(part.edges, part.slopes, part.touch, push_of, starts_of, state, force)
        position = np.einsum("ij,kjc->kic", plant.drives, state[:, : plant.mujoco.nv])
        begin = self.windows.starts[0]
        position[begin:] += np.moveaxis(readings[:, 0], 0, -1)[begin:]
        return np.nan_to_num(position), np.nan_to_num(force)

    def _parts(self) -> Iterable[_Rows]:
        return self._kept if self._numbers * len(self.windows.torque) <= _KEPT else self._worked_out()

    @cached_property
    def _kept(self) -> tuple[_Rows, ...]:
        return tuple(self._worked_out())

    @property
    def _numbers(self) -> int:
        """In one row."""
        size = 2 * self.plant.mujoco.nv
        return (size + 3 * len(self.plant.contacts)) * (size + self.windows.torque.shape[1])

    def _worked_out(self) -> Iterator[_Rows]:
        """Some windows after the other, each part of a size that can be held."""
        world, keep, states, shaft = _ready(self.plant, self.windows)
        columns, edges = plate_columns(self.plant.mujoco, self.plant.contacts), _edges(self.windows)
        size = 2 * self.plant.mujoco.nv
        together = max(1, _KEPT // self._numbers)
        first = 0
        while first < len(states):
            last = max(first + 1, int(np.searchsorted(edges, edges[first] + together, "right")) - 1)
            own = edges[first : last + 1]
            shape = len(shaft[own[0] : own[-1]]), size + shaft.shape[1]
            slopes, touch = np.zeros((shape[0], size, shape[1])), np.zeros((shape[0], len(columns), shape[1]))
            differentiate(
                world, keep.data.sensordata, columns, shaft, self.windows.stride, own, states[first:last],
                slopes, touch,
            )  # fmt: skip
            yield _Rows(own, slopes, touch)
            first = last


_KEPT = 20_000_000  # numbers of eight bytes
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
