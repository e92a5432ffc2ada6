"""Two virtual legs on two buses in simulated time, and a controller that swings them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.can.make import config, motor
from workbench.can import CanConfig, Setpoint
from workbench.deployment import Host, Joints, SimulatedNetwork, Target, joints_of

LIMITS = {"position": [-1.7, 4.0], "velocity": 40.0, "torque": 24.0}
RANGES = {"position": 12.5, "velocity": 45.0, "torque": 25.0, "source": "label"}
HOLD = np.array([-0.55, np.pi / 3])
TICK = 0.003


class Swing:
    """Joints about the hold posture; every part of an answer can be spoilt."""

    def __init__(self, n: int) -> None:
        self.n, self.spoil, self.stuck, self.seen = n, 0.0, None, []

    def target(self, now: float, phase: str, position, velocity, base) -> Target:
        reference = np.resize(HOLD, self.n) + 0.2 * np.sin(6.0 * now)
        made = now if self.stuck is None else self.stuck
        return Target(reference + self.spoil, np.zeros(self.n), made)


def two_legs(folder: Path, **loop: object) -> CanConfig:
    """Four Damiao drives, two a bus."""
    axes = ("left_hip", "left_knee", "right_hip", "right_knee")
    motors = [
        motor(axis, 1 + k % 2, bus=f"can{k // 2}", limits=LIMITS, ranges=RANGES)
        | ({"sign": -1, "offset": 0.3} if k == 3 else {})
        for k, axis in enumerate(axes)
    ]
    legs = [{"model": "leg", "axes": list(axes[:2])}, {"model": "leg", "axes": list(axes[2:])}]
    return config(folder, motors, ("can0", "can1"), mechanism=legs, loop={"soft_start_s": 0.1, **loop})


class Robot:
    """The legs, their buses and the loop, running."""

    def __init__(self, folder: Path, **loop: object) -> None:
        self.config = two_legs(folder, **loop)
        self.joints: Joints = joints_of(self.config)
        self.network = SimulatedNetwork(self.config)
        self.controller = Swing(4)
        self.host = Host(self.config, self.network, self.controller, self.joints)
        self.motors = list(self.network.bank.motors.values())
        self.told: list[tuple[float, str, str | None]] = []

    def start(self) -> Robot:
        """Verified, armed, running."""
        self.host.verify()
        self.arm()
        assert self.host.state.phase == "run", self.host.state
        return self

    def arm(self) -> None:
        """Asked for anew, and time to get going."""
        self.host.operator.arm = False
        self.run(2 * TICK)
        self.host.operator.arm = True
        self.run(0.2)

    def run(self, seconds: float) -> None:
        """Ticks on."""
        self.host.run(seconds, self._tell)

    def until_damped(self, most: float = 0.2) -> float:
        """Ticks on until everything damps; returns the time."""
        self.host.run(most, lambda host, _: host.state.phase == "damp")
        assert self.host.state.phase == "damp", self.host.state
        return self.host.state.since

    def setpoint(self, k: int) -> Setpoint:
        """What motor `k` was last told."""
        return self.motors[k]._setpoint

    def damps(self, k: int) -> bool:
        """Whether motor `k` was last told to damp."""
        s = self.setpoint(k)
        return s.kp == 0.0 and abs(s.kd - 1.0) < 1e-3 and abs(s.torque) < 0.01

    def _tell(self, host: Host, tick: int) -> None:
        self.told.append((self.network.now(), host.state.phase, host.state.fault))
