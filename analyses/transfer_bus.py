"""A policy on the virtual leg over the virtual CAN bus, and its log as a recording."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Sequence
from pathlib import Path

from workbench.bundle import PolicyBundle
from workbench.can import CanConfig, load_config
from workbench.core import Recording
from workbench.deployment import Host, SimulatedNetwork, joints_of
from workbench.deployment.deploy import controller_of
from workbench.deployment.kept import Kept, logged
from workbench.deployment.record import from_run
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


def deployed(
    bundle: PolicyBundle, hidden: Sequence[HiddenEffect], seconds: float, seed: int
) -> tuple[Recording, str | None]:
    """Runs a ``reach`` policy; returns the recording of what the bus carried, and the fault that ended it."""
    with tempfile.TemporaryDirectory() as folder:
        config = _configuration(bundle, Path(folder))
        network, log = (
            SimulatedNetwork(config, MotorBank(config, hidden, seed=seed)),
            Path(folder) / "policy.log",
        )
        joints = joints_of(config)
        kept = Kept(controller_of(bundle, config, joints, seed), joints, config.loop.period_s, seconds)
        with logged(config, log, kept, network.wires):
            host = Host(config, network, kept, joints)
            host.verify()
            host.operator.arm = True
            host.run(seconds + 1.0, lambda at, tick: at.state.phase == "damp" or kept.full)
            fault = host.state.fault
            host.close()
        return from_run(config, log), fault


def _configuration(bundle: PolicyBundle, folder: Path) -> CanConfig:
    machine = hashlib.sha256(bundle.machine.encode()).hexdigest()[:16]
    path = folder / "robot.toml"
    path.write_text(_ROBOT.format(machine=machine))
    return load_config(str(path))
