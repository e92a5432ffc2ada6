"""One run in MuJoCo from its first row to its last, as machine code."""

from __future__ import annotations

import copy
from typing import NamedTuple

import mujoco
import numpy as np

from workbench.core.compiled import compiled
from workbench.effects import Plant

from .control import ControlLaw, tick
from .drives import Drives, pass_on
from .laws import Laws, act, laws_of
from .native import mj_step
from .sense import Sensors, read, record

_TOO_FAST = 1e4  # rad/s or m/s: a run that goes faster is lost


class World(NamedTuple):
    """A mechanism in MuJoCo.

    Attributes:
        model, data: addresses.
        position, speed, force: views into the data, (nv,).
        drives: (n, nv), speeds of the joints to those of the drives.
        give: (nv, n), rate that an impulse on each drive makes, at the model's initial posture.
        substeps: of MuJoCo's in one of the simulation.
        laws: torques of the state.
    """

    model: int
    data: int
    position: np.ndarray
    speed: np.ndarray
    force: np.ndarray
    drives: np.ndarray
    give: np.ndarray
    substeps: int
    laws: Laws


class Keep(NamedTuple):
    """Objects that must live as long as a world."""

    model: mujoco.MjModel
    data: mujoco.MjData


def world_of(plant: Plant, start: np.ndarray) -> tuple[World, Keep]:
    """Return a plant with drives at a position and speed, (2, n), and what keeps its memory alive."""
    model = copy.copy(plant.mujoco) if plant.chain.follows_state else plant.mujoco
    data = mujoco.MjData(model)
    state = plant.state_at(start @ np.linalg.inv(plant.model.transmission).T)
    data.qpos[:], data.qvel[:] = state
    world = World(
        model=model._address,
        data=data._address,
        position=data.qpos,
        speed=data.qvel,
        force=data.qfrc_applied,
        drives=np.ascontiguousarray(plant.drives),
        give=_give(plant),
        substeps=plant.substeps,
        laws=laws_of(plant, model, state),
    )
    return world, Keep(model, data)


def _give(plant: Plant) -> np.ndarray:
    m = plant.mujoco
    data, full = mujoco.MjData(m), np.zeros((m.nv, m.nv))
    mujoco.mj_forward(m, data)
    mujoco.mj_fullM(m, data, full)
    return np.linalg.solve(full, plant.drives.T)


@compiled(nogil=True)
def march(
    world: World,
    control: ControlLaw,
    drives: Drives,
    sensors: Sensors,
    pad: int,
    command: np.ndarray,
    torque: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray,
) -> None:
    """Simulate all K substeps; after the time at which a run diverges, values stay NaN.

    Args:
        world, control, drives, sensors: the run at its start.
        pad: rows of `command` before the first substep, given.
        command: (pad + K + 1, n), filled.
        torque: at the tap, (K + 1, n), filled.
        position, velocity: true motion of the drives, (K + 1, n); the first rows given, the rest filled.
    """
    n, joints, last = torque.shape[1], len(world.speed), len(torque) - 1
    q, w, shaft, early = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    for k in range(last + 1):
        if control.is_tick[k]:
            q[:], w[:] = position[k], velocity[k]
            read(sensors, k, q, w)
            tick(control, k, q, w)
        for i in range(n):
            fed = control.constant[k // control.stride, i] if control.per_row else 0.0
            command[pad + k, i] = control.feedback[i] + fed
        pass_on(drives, command, pad + k, velocity[k], torque[k], shaft, early)
        if k == last:
            return
        _step(world, shaft)
        if drives.fraction > 0.0:
            for j in range(joints):
                for i in range(n):
                    world.position[j] += world.give[j, i] * early[i]
        for i in range(n):
            q[i] = w[i] = 0.0
            for j in range(joints):
                q[i] += world.drives[i, j] * world.position[j]
                w[i] += world.drives[i, j] * world.speed[j]
            if not abs(w[i]) < _TOO_FAST:
                command[pad + k + 1 :], torque[k + 1 :] = np.nan, np.nan
                return
        position[k + 1], velocity[k + 1] = q, w
        record(sensors, k + 1, q, w)


@compiled()
def _step(world: World, shaft: np.ndarray) -> None:
    """Advance by one substep under torques on the drives' shafts, (n,)."""
    for _ in range(world.substeps):
        push(world, shaft)
        mj_step(world.model, world.data)


@compiled()
def push(world: World, shaft: np.ndarray) -> None:
    """Set the forces of MuJoCo's next step: drive torques (n,) and state-dependent laws."""
    for j in range(len(world.force)):
        world.force[j] = 0.0
        for i in range(len(shaft)):
            world.force[j] += world.drives[i, j] * shaft[i]
    if world.laws.present:
        act(world.laws, world.position, world.speed, shaft, world.force)
