"""An actuator alone on a bench, excited by torque without feedback (paper, Sec. IV-A).

One shaft in Drake, J a + B w = tau(t - T_d): between two rows it is linear, so that it is integrated without
error.
"""

from __future__ import annotations

from functools import lru_cache
from math import exp
from typing import Any

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from workbench.core import Controller, Excitation, Recording
from workbench.core.paths import closed_chain_file

from .machine import DRIVE_DELAY, TORQUE_LIMIT
from .virtual_leg import Sensors

ROW = 1e-3  # s
_TICK = 3  # rows; the command is held in between


class VirtualBench:
    """The actuator of Table I on a bench, logged at 1 kHz; commands are held for 3 ms.

    Args:
        seed: of the sensors' noise; run k of a call draws from (seed, k).
        sensors: noise and resolution, as on the virtual leg.
    """

    axes = ("motor",)

    def __init__(self, seed: int = 0, sensors: Sensors | None = None) -> None:
        self.seed, self.sensors = seed, sensors or Sensors()

    def run(self, commands: dict[str, np.ndarray], excitation: Excitation) -> list[Recording]:
        """Play torque commands, and return the recordings.

        Args:
            commands: name -> torque (N,) [N m] at 1 kHz, of which every third row is taken and held.
            excitation: what they are, for the recordings' description.

        Returns:
            One recording a command: position, velocity, torque_command, torque_measured, each (N, 1).
        """
        return [self._record(k, name, u, excitation) for k, (name, u) in enumerate(commands.items())]

    def _record(self, run: int, name: str, wanted: np.ndarray, excitation: Excitation) -> Recording:
        rows = len(wanted)
        generator = np.random.default_rng([self.seed, run])
        command = np.repeat(wanted[::_TICK], _TICK)[:rows]
        late = np.concatenate([np.zeros(round(DRIVE_DELAY / ROW)), command])[:rows]
        torque = np.clip(late, -TORQUE_LIMIT, TORQUE_LIMIT)
        position, velocity = self.shaft(torque)
        step = self.sensors.encoder
        if step:
            position = np.round(position / step) * step
        velocity = velocity + self.sensors.velocity_noise * generator.standard_normal(rows)
        measured = torque + self.sensors.torque_noise * generator.standard_normal(rows)
        signals = {
            "position": position,
            "velocity": velocity,
            "torque_command": command,
            "torque_measured": measured,
        }
        return Recording(
            name=name,
            axes=self.axes,
            coordinates="actuator",
            time=np.arange(rows) * ROW,
            signals={key: values[:, None] for key, values in signals.items()},
            units=("rad",),
            controller=Controller("none", period_s=_TICK * ROW),
            excitation=excitation,
            rig="actuator",
        )

    def shaft(self, torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return angle and speed (N,) at every row under torques (N,) [N m] that are held, from rest."""
        inertia, damping = shaft_constants()
        lag = inertia / damping
        decay = exp(-ROW / lag)
        speed, angle = np.zeros(len(torque)), np.zeros(len(torque))
        q = w = 0.0
        for k, held in enumerate(torque[:-1].tolist(), start=1):
            final = held / damping
            q += final * ROW + (w - final) * (1.0 - decay) * lag
            w = final + (w - final) * decay
            angle[k], speed[k] = q, w
        return angle, speed


@lru_cache(maxsize=1)
def shaft_constants() -> tuple[float, float]:
    """Return inertia [kg m^2] and damping [N m s/rad] of the shaft, as in Drake."""
    plant: Any = MultibodyPlant(0.0)  # Any: Drake's stubs misuse numpy's type parameters
    Parser(plant).AddModels(closed_chain_file("actuator"))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    inertia = float(plant.CalcMassMatrix(context)[0, 0])
    return inertia, float(plant.GetJointByName("shaft").GetDampingVector(context)[0])
