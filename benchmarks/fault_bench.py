"""A robot over CAN that is running, to which one fault happens at a known moment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import tomli_w

from workbench.can import CanConfig, Frame, Setpoint, load_config, make_drive
from workbench.deployment import Host, SimulatedNetwork, Target, joints_of
from workbench.deployment.limits import limits_of
from workbench.rigs import VirtualMotor

PROTOCOLS = "mit", "damiao", "robstride", "moteus", "odrive"
POSTURE, IMU = np.array([-0.55, np.pi / 3] * 2), 0x60
_RANGES = {"position": 12.5, "velocity": 45.0, "torque": 25.0, "source": "of the virtual drives"}
#: What drives of a protocol have that others have not; a moteus damps with all of its kd.
_OWN = {
    "robstride": {"reply_id": 0xFD},
    "moteus": {"ranges": {**_RANGES, "kd": 1.0}},
    "odrive": {"endpoints": {"watchdog_timeout": 481, "enable_watchdog": 482}},
}
_LIMITS = {"position": [-1.7, 4.0], "velocity": 40.0, "torque": 24.0}
_AT = 0.35  # s after the drives were first told to move
_NONE = 0.02  # N m: no more than the two steps about zero of a frame


def robot(folder: Path, protocol: str) -> CanConfig:
    """Two legs, a bus and two drives each, and an inertial unit on the first bus."""
    motors = [
        {
            "axis": f"{side}_{name}", "bus": side, "protocol": protocol, "id": k + 1, "ranges": _RANGES,
            "limits": _LIMITS, "watchdog_source": "of the virtual drives",
            **_OWN.get(protocol, {"reply_id": 17 + k}),
        }
        for side in ("left", "right") for k, name in enumerate(("hip", "knee"))
    ]  # fmt: skip
    buses = [{"name": s, "interface": "workbench", "channel": f"{s}.sock"} for s in ("left", "right")]
    if protocol == "moteus":
        buses = [{**bus, "data_bitrate": 5_000_000} for bus in buses]
    legs = [{"model": "leg", "axes": [f"{s}_hip", f"{s}_knee"]} for s in ("left", "right")]
    content = {"format": 1, "bus": buses, "motor": motors, "mechanism": legs,
               "loop": {"soft_start_s": 0.1}, "imu": {"bus": "left", "id": IMU, "tilt": 0.9}}  # fmt: skip
    path = folder / f"{protocol}.toml"
    path.write_text(tomli_w.dumps(content))
    return load_config(path)


class Swing:
    """FreeDecay the legs; what it answers can be spoilt, late, or nothing at all.

    Attributes:
        since: when it begins to swing [s].
        spoil: is added to its answer [rad].
        stuck: when its answer was made, if it goes on giving the same [s].
    """

    def __init__(self) -> None:
        self.spoil, self.stuck, self.since = 0.0, None, 0.0
        self.before: Callable[[], object] = lambda: None

    def target(self, now: float, phase: str, position, velocity, base) -> Target:
        """See `Controller`."""
        self.before()
        made = now if self.stuck is None else self.stuck
        return Target(
            POSTURE + 0.2 * np.sin(6.0 * max(0.0, now - self.since)) + self.spoil, np.zeros(4), made
        )


class Bench:
    """A robot that is running, and to which a fault happens; what its drives heard is written down."""

    def __init__(self, folder: Path, protocol: str, fault: Fault) -> None:
        self.config = robot(folder, protocol)
        self.network, self.controller = SimulatedNetwork(self.config), Swing()
        self.host = Host(self.config, self.network, self.controller, joints_of(self.config),
                         limits_of(self.config))  # fmt: skip
        self.motors = list(self.network.bank.motors.values())
        self.begun, self._fault = None, fault
        self.stopped: list[float | None] = [None] * 4  # when each drive had no torque any more, for good
        self.damped: float | None = None
        self.ran_on, self.say = False, lambda line: None
        self._told: list[tuple[float, int, float]] = []
        self._listens = [make_drive(motor) for motor in self.config.motor]
        for k, motor in enumerate(self.motors):
            motor.hear = partial(self._hear, k, motor, motor.hear)
        self.network.every_row = self._row
        self._since = np.inf
        fault.before(self)

    @property
    def longest(self) -> float:
        """The longest that a drive drove without a command [s]."""
        return max(motor.longest for motor in self.motors)

    @property
    def rests(self) -> bool:
        """Whether it has had the time to come to rest."""
        return self.network.now() >= self._since + 0.6 * _AT

    def gone(self) -> float | None:
        """From the fault until the last drive had no torque any more [s]."""
        times = [t for t in self.stopped if t is not None]
        return max(times) if len(times) == 4 else None

    def torque_after(self) -> float:
        """Largest torque or stiffness that a drive was told after that."""
        gone = self.gone()
        return max((x for at, _, x in self._told if at > (np.inf if gone is None else gone)), default=0.0)

    def _hear(self, k: int, motor: VirtualMotor, hear: Callable[[Frame], None], frame: Frame) -> None:
        asked = self._listens[k].asked(frame)
        if isinstance(asked, Setpoint) and self.begun is not None:
            now, most = self.network.now() - self.begun, max(abs(asked.torque), asked.kp)
            self._told.append((now, k, most))
            self.stopped[k] = (self.stopped[k] or now) if most < _NONE or not motor.enabled else None
        hear(frame)

    def _row(self, now: float) -> None:
        moving = self.host.state.phase in ("soft_start", "run")
        self._since = min(self._since, now) if moving else self._since
        if self.begun is None and moving and now >= self._since + _AT:
            self.begun = now
            self._fault.happen(self)
        if self.begun is None:
            return
        self._fault.every_row(self, now)
        if self.damped is None and self.host.state.phase == "damp":
            self.damped = now - self.begun
        self.ran_on = self.ran_on or (moving and now > self.begun + 0.1)
        for k, motor in enumerate(self.motors):
            if not motor.enabled:
                self.stopped[k] = self.stopped[k] if self.stopped[k] is not None else now - self.begun


@dataclass(frozen=True)
class Fault:
    """Something that goes wrong.

    Attributes:
        about: in words.
        happen: does it.
        before: what is so from the beginning.
        every_row: goes on doing it.
        harmless: the run is to go on.
        fatal: nobody is left to notice.
    """

    about: str
    happen: Callable[[Bench], object] = lambda bench: None
    before: Callable[[Bench], object] = lambda bench: None
    every_row: Callable[[Bench, float], object] = lambda bench, now: None
    harmless: bool = False
    fatal: bool = False
