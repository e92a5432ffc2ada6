"""Many worlds of one machine on the CPU, through MuJoCo's own batch; what any engine has to offer."""

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
        """One step of all worlds; sensors are those of the beginning of it."""
        ...

    def put(self, where: Array, qpos: Array, qvel: Array) -> None:
        """Begin afresh in the worlds marked by `where` (W,), with these states (W, ...)."""
        ...

    def state(self) -> dict[str, Any]:
        """All that the next step depends on."""
        ...

    def restore(self, state: Mapping[str, Any]) -> None:
        """Go on where `state` was taken."""
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

    def step(self) -> None:
        """One step of all worlds."""
        self._batch.step()

    def put(self, where: np.ndarray, qpos: np.ndarray, qvel: np.ndarray) -> None:
        """Begin afresh where `where` says."""
        ids = np.flatnonzero(where)
        if not len(ids):
            return
        self._batch.reset(ids, stage=mujoco.mjtStage.mjSTAGE_NONE.value)
        self.qpos[ids], self.qvel[ids] = qpos[ids], qvel[ids]
        self._batch.forward(ids)

    def state(self) -> dict[str, Any]:
        """The integration state of every world, and the sensors."""
        return {"rows": self._batch.state.copy(), "sensors": np.array(self.sensordata)}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Set it; sensors are those of the state, until the next step."""
        self._batch.state[...] = state["rows"]
        self._batch.forward()
        self._batch.state[...] = state["rows"]  # forward leaves another warm start


def batch_of(m: mujoco.MjModel, count: int, fields: Fields, threads: int = 0) -> Batch:
    """A batch of a model, with fields that differ from world to world and the constants that follow."""
    batch = Batch(m, count, threads)
    for name, values in fields.items():
        batch.expand(name)[...] = values
    if fields:
        batch.set_const()
    return batch


def derived_fields(m: mujoco.MjModel, count: int, fields: Fields) -> Fields:
    """The same fields, and every constant of the model that differs from world to world because of them."""
    if not fields:
        return {}
    batch = batch_of(m, count, fields)
    found = {name: batch.expanded(name) for name in MODEL_FIELDS}
    return {name: np.array(values) for name, values in found.items() if values is not None}
