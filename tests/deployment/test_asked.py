"""What people ask of a running robot: an emergency stop on a bus, keys, datagrams."""

from __future__ import annotations

import json
import os
import socket
from pathlib import Path

import numpy as np
import pytest

from tests.can.make import config, motor
from tests.deployment.robot import LIMITS, RANGES, TICK, Swing
from workbench.can import Frame
from workbench.core import InputError
from workbench.deployment import Host, SimulatedNetwork, joints_of
from workbench.deployment.command import Command
from workbench.deployment.deploy import run_host
from workbench.deployment.teleop import SILENCE_S, Datagrams, Keys, teleoperated

BUTTON, SILENT = 0x70, 0.05


class Pressed:
    """A leg with a button that says what it is told to, every 20 ms."""

    def __init__(self, folder: Path) -> None:
        motors = [motor(a, k + 1, limits=LIMITS, ranges=RANGES) for k, a in enumerate(("hip", "knee"))]
        loaded = config(folder, motors, mechanism=[{"model": "leg", "axes": ["hip", "knee"]}],
                        loop={"soft_start_s": 0.1},
                        stop={"bus": "can0", "id": BUTTON, "silent_s": SILENT})  # fmt: skip
        self.network = SimulatedNetwork(loaded)
        self.host = Host(loaded, self.network, Swing(2), joints_of(loaded))
        self.says: bytes | None = b"\x01"
        self.due, self.at, self.then = 0.0, np.inf, None
        self.node = self.network.wires["can0"].attach("button", lambda stamp, frame: None)
        self.network.every_row = self.row

    def row(self, now: float) -> None:
        if now >= self.at:
            self.says = self.then
        if now >= self.due and self.says is not None:
            self.due = now + 0.02
            self.network.wires["can0"].send(self.node, Frame(BUTTON, self.says), now)


def test_a_button_that_permits_lets_it_run(tmp_path: Path) -> None:
    robot = Pressed(tmp_path)
    result = run_host(robot.host, robot.network, 0.5)
    assert result["fault"] is None and result["frames"]["stop"] > 20


@pytest.mark.parametrize(
    ("then", "by", "within"),
    [(b"\x00", "the button", 0.02), (b"", "the button", 0.02), (None, "the silence of the button", SILENT)],
)
def test_a_button_that_is_pressed_or_silent_stops(tmp_path: Path, then, by: str, within: float) -> None:
    robot = Pressed(tmp_path)
    robot.at, robot.then = 0.7, then
    damped: list[float] = []
    rows = robot.row

    def row(now: float) -> None:
        rows(now)
        if robot.host.state.phase == "damp":
            damped.append(now)

    robot.network.every_row = row
    result = run_host(robot.host, robot.network, 2.0)
    assert result["stopped"] and result["stopped_by"] == by
    assert 0.0 < damped[0] - 0.7 <= within + 2 * TICK


def test_without_a_word_of_the_button_nothing_moves(tmp_path: Path) -> None:
    robot = Pressed(tmp_path)
    robot.says = None
    result = run_host(robot.host, robot.network, 2.0)
    assert result["stopped_by"] == "the silence of the button"
    assert not any(motor.longest for motor in robot.network.bank.motors.values())


def test_a_button_on_an_identifier_that_is_taken_is_refused(tmp_path: Path) -> None:
    for stop, said in (({"bus": "can0", "id": 1}, "used by another"), ({"bus": "x", "id": 9}, "no bus")):
        with pytest.raises(InputError, match=said):
            config(tmp_path, [motor("m", 1)], stop=stop)


def half(asked: np.ndarray) -> np.ndarray:
    return np.clip(asked, -0.5, 0.5)


def test_keys_ask_step_by_step_and_every_other_key_stops() -> None:
    ours, theirs = os.openpty()
    os.set_blocking(theirs, False)
    import tty

    tty.setcbreak(theirs)
    command = Command()
    keys = Keys(command, half, theirs)
    assert keys.watch() is None
    os.write(ours, b"wwa")
    assert keys.watch() is None and command.asked == pytest.approx([0.2, 0.0, 0.1])
    os.write(ours, b"w" * 20)
    assert keys.watch() is None and command.asked[0] == 0.5
    os.write(ours, b"x")
    assert keys.watch() is None and not command.asked.any()
    os.write(ours, b" ")
    assert keys.watch() == "a key"
    os.close(ours)
    os.close(theirs)


def test_datagrams_ask_and_who_falls_silent_lets_it_stand() -> None:
    clock, command = [0.0], Command()
    ear = Datagrams(command, half, 0, lambda: clock[0])
    mouth = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def say(data: object) -> str | None:
        mouth.sendto(data if isinstance(data, bytes) else json.dumps(data).encode(), ("127.0.0.1", ear.port))
        return ear.watch()

    assert say({"velocity": [0.3, 0, -9]}) is None and command.asked == pytest.approx([0.3, 0.0, -0.5])
    raw = b"", b"\xff", b"[" * 900, b'{"velocity": [NaN, 0, 0]}', b'{"velocity": [1e999, 0, 0]}'
    for bad in (*raw, [], {"velocity": [1, 2]}, {"velocity": ["1", 0, 0]}, {"velocity": [True, 0, 0]}):
        assert say(bad) is None
    assert ear.refused == 9 and command.asked[0] == 0.3
    clock[0] = SILENCE_S + 0.01
    assert ear.watch() is None and not command.asked.any()
    assert say({"stop": True}) == "a datagram"
    mouth.close()
    with pytest.raises(InputError, match="cannot be had"):
        Datagrams(command, half, ear.port, lambda: 0.0)
    ear.close()


@pytest.mark.parametrize("how", ["mouse", "udp:", "udp:99999", "keys"])
def test_another_way_to_ask_is_refused(how: str) -> None:
    with pytest.raises(InputError), teleoperated(how, Command(), half, lambda: 0.0):
        raise AssertionError
