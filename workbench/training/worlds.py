"""Many worlds of one machine on the CPU, with MuJoCo's own batch; also the interface of all engines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import mujoco
import numpy as np
from mujoco.batch import MODEL_FIELDS, Batch

from .machine import Machine
from .randomisation import Fields
from .situation import Array


class Worlds(Protocol):
    """An engine that steps W worlds; arrays are live: what is written is the state at the next step.

    `xp` is the array library of `qpos` (W, nq), `qvel` (W, nv), `ctrl` (W, nu), `sensordata` (W, ns).
    """

    xp: Any
    qpos: Array
    qvel: Array
    ctrl: Array
    sensordata: Array

    def step(self) -> None:
        """Simulate one step of all worlds; the sensors are those at its beginning."""
        ...

    def put(self, where: Array, qpos: Array, qvel: Array) -> None:
        """Restart the worlds marked by `where` (W,) with these states (W, ...)."""
        ...

    def state(self) -> dict[str, Any]:
        """Return everything on which the next step depends."""
        ...

    def restore(self, state: Mapping[str, Any]) -> None:
        """Continue from a `state`."""
        ...


class BatchWorlds:
    """Worlds in double precision on the CPU.

    Args:
        machine: the machine.
        count: how many worlds.
        fields: model fields that differ from world to world, (count, ...) each.
        threads: of the batch; 0 takes all cores. Results do not depend on it.
    """

    xp = np

    def __init__(self, machine: Machine, count: int, fields: Fields | None = None, threads: int = 0) -> None:
        self._batch = batch_of(machine.mujoco, count, fields or {}, threads)
        self.qpos, self.qvel, self.ctrl = (self._batch.bind(name) for name in ("qpos", "qvel", "ctrl"))
        self.sensordata = self._batch.bind("sensordata")
        self.qacc, self.qfrc_applied = (self._batch.bind(name) for name in ("qacc", "qfrc_applied"))

    def step(self) -> None:
        """Simulate one step of all worlds."""
        self._batch.step()

    def put(self, where: np.ndarray, qpos: np.ndarray, qvel: np.ndarray) -> None:
        """Restart the worlds marked by `where`."""
        ids = np.flatnonzero(where)
        if not len(ids):
            return
        self._batch.reset(ids, stage=mujoco.mjtStage.mjSTAGE_NONE.value)
        self.qpos[ids], self.qvel[ids] = qpos[ids], qvel[ids]
        self._batch.forward(ids)

    def state(self) -> dict[str, Any]:
        """Return the integration state of every world, and the sensors."""
        return {"rows": self._batch.state.copy(), "sensors": np.array(self.sensordata)}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Set the state; the sensors are those of the state until the next step."""
        self._batch.state[...] = state["rows"]
        self._batch.forward()
        self._batch.state[...] = state["rows"]  # forward leaves another warm start


def batch_of(m: mujoco.MjModel, count: int, fields: Fields, threads: int = 0) -> Batch:
    """Return a batch of a model, with fields that differ between worlds and the constants derived from
    them.
    """
    batch = Batch(m, count, threads)
    for name, values in fields.items():
        batch.expand(name)[...] = values
    if fields:
        batch.set_const()
    return batch


def derived_fields(m: mujoco.MjModel, count: int, fields: Fields) -> Fields:
    """Return the same fields, and every constant of the model that differs between worlds because of them."""
    if not fields:
        return {}
    batch = batch_of(m, count, fields)
    found = {name: batch.expanded(name) for name in MODEL_FIELDS}
    return {name: np.array(values) for name, values in found.items() if values is not None}
