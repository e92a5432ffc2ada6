"""What can go wrong with a robot over CAN, each as something that is done to it at a known moment."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import tomli_w

from workbench.can import CanConfig, Feedback, Frame, Setpoint, load_config, make_drive
from workbench.can.imu import WorkbenchImu
from workbench.deployment import Host, SimulatedNetwork, Target, joints_of
from workbench.deployment.limits import limits_of
from workbench.deployment.network import Arrival
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
    """Swings the legs; what it answers can be spoilt, late, or nothing at all.

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


def _tamper(change: Callable[[Bench, Arrival], list[tuple[float, Arrival]]]) -> Callable[[Bench], None]:
    def happen(bench: Bench) -> None:
        bench.network.tamper = lambda a: [(a.stamp, a)] if a.sent else change(bench, a)

    return happen


def _says(**more: float) -> Callable[[Bench], None]:
    """The first drive says something else than it has to."""

    def happen(bench: Bench) -> None:
        drive = bench.motors[0].drive
        own = {key: value for key, value in more.items() if key != "shift"}

        def wrong(says: Callable[..., object], said: Feedback, *when: float) -> object:
            shifted = said._replace(enabled=True, position=said.position + more.get("shift", 0.0))
            return says(shifted._replace(**own), *when)

        for name in ("answer", "unasked"):
            if says := getattr(drive, name, None):
                setattr(drive, name, partial(wrong, says))

    return happen


def _unit(frames: list[Frame]) -> Callable[[Bench], None]:
    """The inertial unit says this."""
    own = {frame.id: frame for frame in frames}  # what it says besides these goes on
    return _tamper(lambda bench, a: [(a.stamp, a._replace(frame=own.get(a.frame.id, a.frame)))])


def _frozen(bench: Bench) -> None:
    last: dict[tuple[str, int], Frame] = {}

    def change(bench: Bench, a: Arrival) -> list[tuple[float, Arrival]]:
        if a.frame.id in WorkbenchImu(IMU).ids:
            return [(a.stamp, a)]
        return [(a.stamp, a._replace(frame=last.setdefault((a.bus, a.frame.id), a.frame)))]

    _tamper(change)(bench)


def _begins(bench: Bench) -> None:
    bench.controller.since = bench.network.now()


def _at_rest(bench: Bench) -> None:
    """Nothing moves; after some time the drives of one bus go on saying the same."""
    bench.controller.since = np.inf
    _frozen(bench)
    change = bench.network.tamper
    assert change is not None
    bench.network.tamper = lambda a: change(a) if bench.rests and a.bus == "left" else [(a.stamp, a)]


def _let_go(bench: Bench) -> None:
    """A drive is off by itself; a moteus follows again what it is told, unless something is wrong with it."""
    motor = bench.motors[1]
    motor.enabled = False
    if motor.drive.name == "moteus":
        motor.fault = 33


def _raises(error: BaseException) -> Callable[..., None]:
    def fails(*args: object) -> None:
        raise error

    return fails


def _in_controller(what: Callable[[Bench], object]) -> Callable[[Bench], None]:
    return lambda bench: setattr(bench.controller, "before", lambda: what(bench))


def _once(what: Callable[[Bench], object]) -> Callable[[Bench], None]:
    def happen(bench: Bench) -> None:
        def before() -> None:
            bench.controller.before = lambda: None
            what(bench)

        bench.controller.before = before

    return happen


def _held_up(seconds: float) -> Callable[[Bench], None]:
    return _once(lambda bench: bench.network.sleep_until(bench.network.now() + seconds))


def _vanishes(bench: Bench) -> None:
    """The host is no more: nothing is sent, by nobody, not even on its way out."""
    bench.network.send = lambda bus, frame: True  # type: ignore[method-assign]
    raise SystemExit


def _losing(part: float) -> Callable[[Bench], None]:
    def happen(bench: Bench) -> None:
        generator = np.random.default_rng(1)
        for wire in bench.network.wires.values():
            wire.lost = lambda node, frame: generator.random() < part

    return happen


def _noise(bench: Bench, now: float) -> None:
    generator, wire = np.random.default_rng(round(1e6 * now)), bench.network.wires["right"]
    node = wire.attach("noise", lambda stamp, frame: None)
    wire.send(
        node, Frame(int(generator.integers(0x60, 0x7FF)), generator.bytes(int(generator.integers(8)))), now
    )


def _bus_off(bench: Bench) -> None:
    host = bench.network.hosts["left"]
    bench.network.wires["left"].damaged = lambda node, frame: node is host


def _queue_full(bench: Bench) -> None:
    wire, host = bench.network.wires["left"], bench.network.hosts["left"]
    takes = wire.send
    wire.send = lambda node, frame, now: node is not host and takes(node, frame, now)  # type: ignore[method-assign]


def _press(bench: Bench) -> None:
    bench.host.operator.press("a button")


def _kill(number: signal.Signals) -> Callable[[Bench], None]:
    return lambda bench: os.kill(os.getpid(), number)


def _wall_clock(bench: Bench) -> None:
    real = time.time
    time.time = lambda: real() + 3600.0  # type: ignore[assignment]
    bench.say = lambda line: None
    _once(lambda b: setattr(time, "time", real))(bench)


_SIDE, _COS = np.sin(1.1), np.cos(1.1)
_TILTED = WorkbenchImu(IMU).encode((0.0, 0.0, 0.0), (0.0, -_SIDE, -_COS), (0.0, _SIDE, _COS))
_STILL = WorkbenchImu(IMU).encode((0.01, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 0.0, 1.0))
_FALLS = WorkbenchImu(IMU).encode((0.01, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 0.0, 0.02))[2:]
_LATE = 0.012

FAULTS: tuple[Fault, ...] = (
    Fault("a bus is off", _bus_off),
    Fault("a transmit queue is full", _queue_full),
    Fault("a drive is dead", lambda b: setattr(b.motors[3], "dead", True)),
    Fault("all feedback is 12 ms late", _tamper(lambda b, a: [(a.stamp + _LATE, a)])),
    Fault("feedback is frozen, the robot moves", _frozen),
    Fault("feedback freezes at rest, then the robot is to move", _begins, before=_at_rest),
    Fault("a position jumps by 1 rad and stays", _says(shift=1.0)),
    Fault("a speed beyond its limit", _says(velocity=42.0)),
    Fault("a temperature beyond its limit", _says(temperature=90.0)),
    Fault("a drive reports a fault (voltage, current, encoder ...)", _says(fault=9)),
    Fault("a drive lets go by itself", _let_go),
    Fault("the inertial unit is silent", _tamper(lambda b, a: [] if a.frame.id == IMU else [(a.stamp, a)])),
    Fault("the inertial unit is frozen", _unit(_STILL)),
    Fault("the robot is tilted beyond its limit", _unit(_TILTED)),
    Fault("the robot falls without tilting", _unit(_FALLS)),
    Fault("an action is not a number", lambda b: setattr(b.controller, "spoil", np.nan)),
    Fault("an action is huge", lambda b: setattr(b.controller, "spoil", 60.0)),
    Fault("a policy repeats its last action", lambda b: setattr(b.controller, "stuck", b.network.now())),
    Fault("a policy raises an error", _in_controller(_raises(RuntimeError("no network")))),
    Fault("a policy answers after 100 ms", _held_up(0.1)),
    Fault("an error in the program itself", lambda b: b.host.operator.watches.append(_raises(OSError()))),
    Fault("the emergency stop (Ctrl-C)", _kill(signal.SIGINT)),
    Fault("SIGTERM", _kill(signal.SIGTERM)),
    Fault("SIGHUP: terminal or connection gone", _kill(signal.SIGHUP)),
    Fault("`kill -9`, SIGSTOP, no power", _in_controller(_vanishes), fatal=True),
    Fault("the loop is held up for 12 ms", _held_up(0.012), harmless=True),
    Fault("one frame in a hundred is lost", _losing(0.01), harmless=True),
    Fault("garbage on the bus", every_row=_noise, harmless=True),
    Fault("the wall clock jumps by an hour", _wall_clock, harmless=True),
)  # fmt: skip
