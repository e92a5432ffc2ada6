"""Bus, motors and loop as processes of their own: they run, and whoever is killed leaves no drive driving."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from subprocess import Popen

import numpy as np
import pytest

from tests.can.make import motor, table, written
from tests.deployment.robot import LIMITS, RANGES, Swing
from workbench.can import load_config, make_drive
from workbench.can.candump import packed, read_candump
from workbench.deployment import Host, joints_of
from workbench.deployment.ports import PortNetwork
from workbench.deployment.processes import ProcessError, end, start, virtual_hardware


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    motors = [motor(axis, k + 1, limits=LIMITS, ranges=RANGES) for k, axis in enumerate(("hip", "knee"))]
    # slow enough that whoever shares this machine delays nothing by as much as a limit
    content = table(motors, mechanism=[{"model": "leg", "axes": ["hip", "knee"]}],
                    loop={"soft_start_s": 0.1}, bench={"time_scale": 8.0})  # fmt: skip
    content["bus"][0]["channel"] = str(tmp_path / "can0")
    return written(tmp_path, content)


@contextmanager
def bus_and_motors(robot: Path) -> Iterator[tuple[Popen[str], Popen[str]]]:
    """The two processes of the virtual hardware, to be stopped one by one."""
    bus, motors = (start("can", what, str(robot)) for what in ("bus", "motors"))
    try:
        yield bus, motors
    finally:
        end(motors)
        end(bus)


def held_up(host: Host) -> bool:
    """Whether it stopped as it must where a machine held a process up: somebody was silent too long."""
    fault = str(host.state.fault)
    drives = host.feedback.fault if "reports a fault" in fault else ()
    return "no feedback" in fault or any("watchdog" in said for said in (fault, *drives))


def running_at_last(host: Host, moves: Callable[[], None]) -> bool:
    """Whether the host runs after some moves; asked for anew where a busy machine held a process up."""
    for _ in range(4):
        moves()
        if host.state.phase == "run" or not held_up(host):
            break
        host.operator.arm = False
        host.run(0.02)
        host.operator.arm = True
        host.run(0.3)
    return host.state.phase == "run"


#: What a drive of another protocol has that a damiao has not.
OTHERS = {
    "damiao": {},
    "moteus": {"protocol": "moteus", "reply_id": 0, "ranges": {**RANGES, "kd": 1.0}},
    "odrive": {"protocol": "odrive", "endpoints": {"watchdog_timeout": 481, "enable_watchdog": 482}},
}


@pytest.mark.parametrize("protocol", OTHERS)
def test_a_leg_runs_across_processes(robot: Path, protocol: str) -> None:
    content = tomllib.loads(robot.read_text())
    content["motor"] = [{**each, **OTHERS[protocol]} for each in content["motor"]]
    if protocol == "moteus":
        content["bus"][0]["data_bitrate"] = 5_000_000
    config = load_config(written(robot.parent, content))
    with virtual_hardware(robot) as running:
        network = PortNetwork(config)
        host = Host(config, network, Swing(2), joints_of(config))
        told = host.verify()
        assert [v.told["watchdog"] for v in told] == pytest.approx([0.02, 0.02])
        host.operator.arm = True
        moved = []

        def move() -> None:
            moved.clear()
            host.run(1.0, lambda h, _: moved.append(h.feedback.position.copy()))

        assert running_at_last(host, move), host.state
        assert running() and host.punctuality.counts["feedback"] > 200
        assert host.punctuality.counts["garbage"] == 0
        assert np.ptp(np.array(moved[20:]), axis=0).min() > 0.05
        host.close(0.02)
        network.close()


HOST = """
import sys
from tests.deployment.robot import Swing
from workbench.can import load_config, make_drive
from workbench.can.candump import packed, read_candump
from workbench.deployment import Host, joints_of
from workbench.deployment.ports import PortNetwork
config = load_config(sys.argv[1])
host = Host(config, PortNetwork(config), Swing(2), joints_of(config))
host.verify()
host.operator.arm = True

def each(h, k):
    if h.state.phase == "damp":  # the machine held something up: asked for anew
        h.operator.arm = not h.operator.arm
    if h.state.phase == "run" and k % 10 == 0:
        print("run", flush=True)

host.run(60.0, each)
"""


def test_drives_stop_when_the_host_is_stopped(robot: Path) -> None:
    with bus_and_motors(robot) as (_, motors):
        host = Popen([sys.executable, "-c", HOST, str(robot)], stdout=subprocess.PIPE, text=True)
        try:
            assert host.stdout and host.stdout.readline().strip() == "run"
            host.send_signal(signal.SIGSTOP)  # to a drive the same as SIGKILL
            time.sleep(load_config(robot).clock.machine(0.1))
            motors.send_signal(signal.SIGTERM)
            said, _ = motors.communicate(timeout=20)
        finally:
            host.kill()
            host.wait()
    longest = re.search(r"longest without a command: ([\d.]+) ms", said)
    assert longest and 10.0 < float(longest[1]) <= 20.0 + 2 * 0.5, said
    assert "driving: none" in said


def test_a_log_whose_writer_is_killed_is_readable(robot: Path) -> None:
    config, log = load_config(robot), robot.parent / "run.log"
    with virtual_hardware(robot):
        logger = start("can", "log", str(robot), "-o", str(log))
        with pytest.raises(ProcessError, match=r"run\.log"):
            start("can", "log", str(robot), "-o", str(log))
        network = PortNetwork(config)
        host = Host(config, network, Swing(2), joints_of(config))
        host.verify()
        host.run(0.4)
        logger.kill()
        logger.communicate()
        network.close()
    frames = list(read_candump(log))
    assert len(frames) > 50 and packed(log)[0] == len(frames)
    pair = json.loads(log.with_suffix(".clock").read_text().splitlines()[0])
    assert {"monotonic", "wall", "shift"} <= pair.keys()


def test_drives_stop_when_the_bus_is_killed(robot: Path) -> None:
    config = load_config(robot)
    with bus_and_motors(robot) as (bus, motors):
        network = PortNetwork(config)
        host = Host(config, network, Swing(2), joints_of(config))
        host.verify()
        host.operator.arm = True
        host.run(0.2)
        bus.kill()
        host.run(0.1)
        assert host.state.phase in ("damp", "off")
        said, _ = motors.communicate(timeout=20)
        assert "driving: none" in said
        network.close()


def test_motors_that_were_held_up_catch_up_and_go_on(robot: Path) -> None:
    config = load_config(robot)
    with bus_and_motors(robot) as (_, motors):
        network = PortNetwork(config)
        host = Host(config, network, Swing(2), joints_of(config))
        host.verify()
        host.operator.arm = True
        host.run(0.3)

        def hold_up() -> None:
            for _ in range(3):
                motors.send_signal(signal.SIGSTOP)
                host.run(0.003)
                motors.send_signal(signal.SIGCONT)
                host.run(0.05)

        assert running_at_last(host, hold_up), host.state
        host.close(0.02)
        network.close()


def test_a_program_that_is_told_to_end_damps_and_disables_first(robot: Path) -> None:
    config, log = load_config(robot), robot.parent / "run.log"
    with virtual_hardware(robot):
        logger = start("can", "log", str(robot), "-o", str(log))
        words = ["deploy", "tracker", str(robot), "--yes", "--seconds", "60", "-o", ""]
        run = subprocess.Popen(
            [sys.executable, "-m", "workbench.cli", *words],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        assert run.stderr and any(line.startswith("run") for line in run.stderr)
        run.send_signal(signal.SIGTERM)
        time.sleep(0.3)
        run.send_signal(signal.SIGTERM)
        run.communicate(timeout=60)
        end(logger)
    assert run.returncode in (128 + signal.SIGTERM, 1), "1: the machine held something up just then"
    drives = [make_drive(motor) for motor in config.motor]
    for drive in drives:
        told = [asked for each in read_candump(log) if (asked := drive.asked(each.frame)) is not None]
        assert told[-3:] == ["disable"] * 3
        calm = told[-103:-3]
        assert all(s.kp == 0 and s.kd > 0.9 and abs(s.torque) < 0.01 for s in calm)  # pyright: ignore
