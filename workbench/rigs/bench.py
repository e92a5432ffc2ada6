"""An actuator alone on a bench, excited by torque without feedback (paper, Sec. IV-A).

One shaft in Drake, J a + B w = tau(t - T_d): between two rows and two changes of sign of w it is linear, so
that it is integrated without error, dry friction and all.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import exp, log
from typing import Any

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from workbench.core import Controller, Excitation, Recording
from workbench.core.paths import closed_chain_file

from .drive_side import DriveSide, drive_side
from .hidden import HiddenEffect
from .machine import ACTUATOR_DAMPING, ACTUATOR_INERTIA, DRIVE_DELAY, TORQUE_LIMIT
from .virtual_leg import Sensors

_ROW = 1e-3  # s
_TICK = 3  # rows; the command is held in between


class VirtualBench:
    """The actuator of Table I on a bench, logged at 1 kHz; commands are held for 3 ms.

    Args:
        seed: of the sensors' noise; run k of a call draws from (seed, k).
        sensors: noise and resolution, as on the virtual leg.
        hidden: effects of the leg that the drive was taken from; those of the links are not on the bench.
        axis: of the leg, where the drive was.

    Raises:
        InputError: the drive hides what the bench cannot have.
    """

    axes = ("motor",)

    def __init__(
        self,
        seed: int = 0,
        sensors: Sensors | None = None,
        hidden: Sequence[HiddenEffect] = (),
        axis: str = "hip",
    ) -> None:
        self.seed, self.sensors = seed, sensors or Sensors()
        self._drive = drive_side(hidden, axis)

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
        late = np.concatenate([np.zeros(round(DRIVE_DELAY / _ROW)), command])[:rows]
        torque = np.clip(late, -TORQUE_LIMIT, TORQUE_LIMIT)
        position, velocity = _shaft(torque, self._drive)
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


def _shaft(torque: np.ndarray, drive: DriveSide) -> tuple[np.ndarray, np.ndarray]:
    """Angle and speed at every row under measured torques (N,) held from row to row, from rest."""
    inertia, damping = shaft_constants()
    inertia += drive.inertia - ACTUATOR_INERTIA
    damping += drive.damping - ACTUATOR_DAMPING
    speed, angle = np.zeros(len(torque)), np.zeros(len(torque))
    q = w = 0.0
    for k in range(len(torque) - 1):
        true, left = drive.gain * float(torque[k]), _ROW
        while left > 0.0:
            sign = np.sign(w) or np.sign(true)
            if w == 0.0 and abs(true) <= drive.friction:
                break  # it sticks
            final, lag = (true - sign * drive.friction) / damping, inertia / damping
            # the speed w(t) = final + (w - final) exp(-t / lag) turns round where friction does
            stops = w != 0.0 and final * w < 0.0
            until = min(left, lag * log(1.0 - w / final)) if stops else left
            decay = exp(-until / lag)
            q += final * until + (w - final) * (1.0 - decay) * lag
            w = 0.0 if stops and until < left else final + (w - final) * decay
            left -= until
        angle[k + 1], speed[k + 1] = q, w
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
