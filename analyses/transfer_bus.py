"""A policy on the virtual leg over the virtual CAN bus, and its log as a recording."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from workbench.bundle import PolicyBundle
from workbench.can import CanConfig, Wire, load_config
from workbench.can.candump import line, read_candump
from workbench.core import Excitation, Recording
from workbench.deployment import Controller, Host, SimulatedNetwork, Target, joints_of
from workbench.deployment.deploy import controller_of
from workbench.deployment.from_log import Played, recording
from workbench.rigs import HiddenEffect, MotorBank

_ROBOT = """
format = 1
name = "leg"
machine = "{machine}"
[loop]
period_s = 0.003
kp = 50.0
kd = 1.5
damping = 1.0
[[bus]]
name = "can0"
interface = "workbench"
channel = "can0.sock"
[[motor]]
axis = "hip"
bus = "can0"
protocol = "damiao"
id = 1
reply_id = 0x11
ranges = {{ position = 12.5, velocity = 45.0, torque = 25.0, source = "label" }}
limits = {{ position = [-1.6, 1.6], velocity = 40.0, torque = 24.0 }}
[[motor]]
axis = "knee"
bus = "can0"
protocol = "damiao"
id = 2
reply_id = 0x12
ranges = {{ position = 12.5, velocity = 45.0, torque = 25.0, source = "label" }}
limits = {{ position = [-1.3, 4.0], velocity = 40.0, torque = 24.0 }}
[[mechanism]]
model = "leg"
axes = ["hip", "knee"]
"""


class Told:
    """A controller that remembers what it asked for once the loop ran: times (N,) and joint angles (N, n)."""

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self.time: list[float] = []
        self.reference: list[np.ndarray] = []

    def target(
        self, now: float, phase: str, position: np.ndarray, velocity: np.ndarray, base: Any
    ) -> Target | None:
        """What the controller says."""
        asked = self._controller.target(now, phase, position, velocity, base)
        if phase == "run" and asked is not None:
            self.time.append(now)
            self.reference.append(np.array(asked.reference))
        return asked


def deployed(
    bundle: PolicyBundle, hidden: Sequence[HiddenEffect], seconds: float, seed: int
) -> tuple[Recording, str | None]:
    """Runs a ``reach`` policy; returns the recording of what the bus carried, and the fault that ended it."""
    with tempfile.TemporaryDirectory() as folder:
        config = _configuration(bundle, Path(folder))
        network, log = (
            SimulatedNetwork(config, MotorBank(config, hidden, seed=seed)),
            Path(folder) / "run.log",
        )
        lines: list[str] = []
        for name, wire in network.wires.items():
            _listen(name, wire, lines)
        joints = joints_of(config)
        told = Told(controller_of(bundle, config, joints, seed))
        host = Host(config, network, told, joints)
        host.verify()
        host.operator.arm = True
        host.run(seconds + 1.0, lambda at, tick: at.state.phase == "damp" or len(told.time) * 0.003 > seconds)
        fault = host.state.fault
        host.close()
        log.write_text("".join(lines))
        reference = np.array(told.reference)
        played = Played("policy", told.time[0], reference, np.zeros_like(reference), Excitation("policy"))
        return recording(config, read_candump(log), played), fault


def _configuration(bundle: PolicyBundle, folder: Path) -> CanConfig:
    machine = hashlib.sha256(bundle.machine.encode()).hexdigest()[:16]
    path = folder / "robot.toml"
    path.write_text(_ROBOT.format(machine=machine))
    return load_config(str(path))


def _listen(name: str, wire: Wire, lines: list[str]) -> None:
    wire.attach("logger", lambda stamp, frame: lines.append(line(stamp, name, frame)))
