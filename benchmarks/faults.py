"""What can go wrong with a robot over CAN, each as something that is done to it at a known moment."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from fault_bench import IMU, Bench, Fault

from workbench.can import Feedback, Frame
from workbench.can.imu import WorkbenchImu
from workbench.deployment.network import Arrival


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
