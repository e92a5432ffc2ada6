"""An actuator alone on a bench, excited by torque without feedback (paper, Sec. IV-A).

One shaft in Drake, J a + B w = tau(t - T_d): linear, so each row is integrated without error by the matrix
exponential of what Drake says of the shaft.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from workbench.core import Controller, Excitation, Recording
from workbench.core.paths import closed_chain_file

from .machine import DRIVE_DELAY, TORQUE_LIMIT
from .virtual_leg import Sensors

_ROW = 1e-3  # s
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
        """Plays torque commands.

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
        late = np.concatenate([np.zeros(round(DRIVE_DELAY / _ROW)), command])[:rows]
        torque = np.clip(late, -TORQUE_LIMIT, TORQUE_LIMIT)
        position, velocity = _shaft(torque)
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
            time=np.arange(rows) * _ROW,
            signals={key: values[:, None] for key, values in signals.items()},
            units=("rad",),
            controller=Controller("none", period_s=_TICK * _ROW),
            excitation=excitation,
            rig="actuator",
        )


def _shaft(torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angle and speed at every row under torques (N,) held from row to row, from rest."""
    inertia, damping = shaft_constants()
    decay = np.exp(-damping / inertia * _ROW)
    speed, angle = np.zeros(len(torque)), np.zeros(len(torque))
    for k in range(len(torque) - 1):
        final = torque[k] / damping
        speed[k + 1] = final + (speed[k] - final) * decay
        angle[k + 1] = angle[k] + final * _ROW + (speed[k] - final) * (1.0 - decay) * inertia / damping
    return angle, speed


@lru_cache(maxsize=1)
def shaft_constants() -> tuple[float, float]:
    """Inertia [kg m^2] and damping [N m s/rad] of the shaft, as Drake has them."""
    plant: Any = MultibodyPlant(0.0)  # Any: Drake's stubs misuse numpy's type parameters
    Parser(plant).AddModels(closed_chain_file("actuator"))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    inertia = float(plant.CalcMassMatrix(context)[0, 0])
    return inertia, float(plant.GetJointByName("shaft").GetDampingVector(context)[0])
