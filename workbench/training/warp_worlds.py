"""Many worlds of one machine on a GPU, with MuJoCo Warp (single precision); on the CPU for tests only."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp

from .machine import Machine
from .randomisation import Fields
from .worlds import derived_fields

_ROWS = 64  # constraints a world has room for: 16 of four feet, the rest for joints with friction
_CONTACTS = 8


class WarpWorlds:
    """Worlds in single precision; the interface is that of `worlds.Worlds`.

    Args:
        machine: the machine.
        count: how many worlds.
        fields: model fields that differ from world to world, (count, ...) each.
        device: of torch and Warp, ``cuda:0`` or ``cpu``.
    """

    xp = torch

    def __init__(self, machine: Machine, count: int, fields: Fields, device: str) -> None:
        wp.config.quiet = True
        self._device = wp.get_device(device)
        m = machine.mujoco
        every = derived_fields(m, count, fields)
        with wp.ScopedDevice(self._device):
            self._m: Any = mjw.put_model(m, batch_sizes=dict.fromkeys(_batched(every), count))
            for name in _batched(every):
                getattr(self._m, name).assign(_packed(getattr(self._m, name), every[name]))
            self._m.opt.warn_overflow = 0
            self._d: Any = mjw.put_data(
                m, mujoco.MjData(m), nworld=count, nconmax=_CONTACTS, njmax=_ROWS + 2 * m.nv
            )
        views = (wp.to_torch(getattr(self._d, name)) for name in ("qpos", "qvel", "ctrl", "sensordata"))
        self.qpos, self.qvel, self.ctrl, self.sensordata = views
        self.qacc, self.qfrc_applied = wp.to_torch(self._d.qacc), wp.to_torch(self._d.qfrc_applied)
        self._warm, self._time = wp.to_torch(self._d.qacc_warmstart), wp.to_torch(self._d.time)
        self._graph = self._capture() if self._device.is_cuda else None

    def step(self) -> None:
        """Simulate one step of all worlds, in the order of torch's own work."""
        if self._graph is None:
            with wp.ScopedDevice(self._device):
                mjw.step(self._m, self._d)
            return
        stream = wp.stream_from_torch(torch.cuda.current_stream(str(self._device)))
        wp.capture_launch(self._graph, stream=stream)

    def put(self, where: torch.Tensor, qpos: torch.Tensor, qvel: torch.Tensor) -> None:
        """Restart the worlds marked by `where`, without waiting for the GPU."""
        column = where[:, None]
        self.qpos.copy_(torch.where(column, qpos, self.qpos))
        self.qvel.copy_(torch.where(column, qvel, self.qvel))
        for array in (self.ctrl, self.sensordata, self._warm):
            array.masked_fill_(column, 0.0)
        self._time.masked_fill_(where, 0.0)

    def state(self) -> dict[str, Any]:
        """Return positions, speeds, the warm start of the solver, and the sensors."""
        return {name: array.clone() for name, array in self._arrays().items()}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Set the state."""
        for name, array in self._arrays().items():
            array.copy_(state[name])

    def _arrays(self) -> dict[str, torch.Tensor]:
        names = "qpos", "qvel", "ctrl", "sensors", "warm", "time"
        arrays = self.qpos, self.qvel, self.ctrl, self.sensordata, self._warm, self._time
        return dict(zip(names, arrays, strict=True))

    def _capture(self) -> Any:
        """A CUDA graph of one step; the state is as it was."""
        before = self.state()
        with wp.ScopedDevice(self._device):
            mjw.step(self._m, self._d)  # compiles what has to be
            with wp.ScopedCapture() as capture:
                mjw.step(self._m, self._d)
        wp.synchronize_device(self._device)
        self.restore(before)
        return capture.graph


def _batched(fields: Fields) -> list[str]:
    """Those that MuJoCo Warp keeps a world; what it does not have at all does not matter to a step."""
    known = mjw.Model.__dataclass_fields__
    return [name for name in fields if name in known and getattr(known[name].type, "shape", ())[:1] == ("*",)]


def _packed(array: Any, values: np.ndarray) -> np.ndarray:
    """Numbers in the shape and kind of a Warp array."""
    return np.ascontiguousarray(values.reshape(array.numpy().shape), dtype=array.numpy().dtype)
