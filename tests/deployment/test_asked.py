"""What people ask of a running robot: an emergency stop on a bus or a line, keys, a gamepad, datagrams."""

from __future__ import annotations

import json
import os
import socket
import struct
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
from workbench.deployment.gamepad import Gamepad
from workbench.deployment.gpio import Line, stop_line
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
    [
        (b"\x00", "the button", 0.02),
        (b"", "the button", 0.02),
        (None, "a missing signal of the button", SILENT),
    ],
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
    assert result["stopped_by"] == "a missing signal of the button"
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


def event(kind: int, number: int, value: int) -> bytes:
    return struct.pack("=IhBB", 1234, value, kind, number)


def test_a_gamepad_asks_by_its_sticks_and_any_button_stops(tmp_path: Path) -> None:
    device, command = tmp_path / "js0", Command()
    os.mkfifo(device)
    pad = Gamepad(command, half, str(device))
    hand = os.open(device, os.O_WRONLY)
    begin = b"".join(event(0x81, k, 0) + event(0x82, k, 0) for k in range(8))
    os.write(hand, begin)
    assert pad.watch() is None and not command.asked.any(), "what is so when it is opened is no press"
    os.write(hand, event(2, 1, -16384) + event(2, 3, 32767))
    assert pad.watch() is None and command.asked == pytest.approx([0.5, 0.0, -0.5], abs=1e-3)
    os.write(hand, event(2, 0, -9830) + event(2, 5, 32767))
    assert pad.watch() is None and command.asked == pytest.approx([0.5, 0.15, -0.5], abs=1e-3)
    for axis, asked in ((1, (0.25, 0.0, 0.0)), (0, (0.0, 0.125, 0.0)), (3, (0.0, 0.0, 0.25))):
        os.write(hand, b"".join(event(2, k, -8192 if k == axis else 0) for k in (0, 1, 3)))
        assert pad.watch() is None and command.asked == pytest.approx(asked, abs=1e-4)
    os.write(hand, event(2, 0, 3000) + event(2, 1, -3000) + event(2, 3, 0))
    assert pad.watch() is None and not command.asked.any(), "sticks that are let go are not quite at zero"
    os.write(hand, event(1, 4, 0))
    assert pad.watch() is None, "a button that is let go is no press"
    os.write(hand, event(1, 4, 1))
    assert pad.watch() == "a button of the gamepad"
    os.close(hand)
    assert pad.watch() == "the end of the gamepad"
    pad.close()
    with pytest.raises(InputError, match=r"no gamepad at .*none \(No such file or directory\)") as caught:
        Gamepad(command, half, str(tmp_path / "none"))
    assert caught.value.exit_code == 2 and "\n" not in str(caught.value)


def test_ways_to_steer_are_closed_again(tmp_path: Path) -> None:
    device, command = tmp_path / "js1", Command()
    os.mkfifo(device)
    with teleoperated(f"pad:{device}", command, half, lambda: 0.0) as [watch]:
        hand = os.open(device, os.O_WRONLY)
        os.write(hand, event(2, 1, -32767))
        assert watch() is None and command.asked[0] == 0.5
    with pytest.raises(BrokenPipeError):
        os.write(hand, b"x")
    os.close(hand)
    for how in ("paddle", "pad:/nowhere", "udp:0", "udp:x"):
        with pytest.raises(InputError), teleoperated(how, command, half, lambda: 0.0):
            pass


class Kernel:
    """A chip with a button on line 17, by linux/gpio.h: sizes and offsets as compiled C has them."""

    def __init__(self, pulls: bool = True) -> None:
        self.high, self.gone, self.pulls, self.asked = True, False, pulls, list[int]()

    def __call__(self, file: int, number: int, data: bytearray) -> None:
        if number == 0xC250B407:
            assert len(data) == 592 and data[256:270] == b"workbench stop"
            line, flags = struct.unpack_from("=I", data)[0], struct.unpack_from("=Q", data, 288)[0]
            lines = struct.unpack_from("=I", data, 560)[0]
            self.asked.append(flags)
            if line != 17 or lines != 1 or (flags & 1 << 9 and not self.pulls):
                raise OSError(22, "Invalid argument")
            struct.pack_into("=i", data, 588, os.dup(file))
        else:
            assert number == 0xC010B40E and len(data) == 16 and struct.unpack_from("=Q", data, 8)[0] == 1
            if self.gone:
                raise OSError(19, "No such device")
            struct.pack_into("=Q", data, 0, int(self.high))


@pytest.mark.parametrize("pulls", [True, False])
def test_a_line_of_the_computer_stops_when_it_is_low_or_gone(tmp_path: Path, pulls: bool) -> None:
    chip, kernel = tmp_path / "gpiochip0", Kernel(pulls)
    chip.touch()
    table = {"chip": str(chip), "line": 17}
    with stop_line(config(tmp_path, [motor("m", 1)], stop=table), kernel) as [watch]:
        assert watch() is None
        kernel.high = False
        assert watch() == "the line of the button"
        kernel.high, kernel.gone = True, True
        assert watch() == "the line of the button, which is gone"
    assert kernel.asked == ([1 << 2 | 1 << 9] if pulls else [1 << 2 | 1 << 9, 1 << 2]), (
        "pulled down, if it can be"
    )
    table["line"] = 3
    said = r"line 3 of .*gpiochip0 cannot be opened \(Invalid argument\)"
    other = config(tmp_path, [motor("m", 1)], stop=table)
    with pytest.raises(InputError, match=said), stop_line(other, kernel):
        pass
    with pytest.raises(InputError, match="No such file"):
        Line(str(tmp_path / "none"), 17)
    with stop_line(config(tmp_path, [motor("m", 1)]), kernel) as watches:
        assert watches == []


@pytest.mark.parametrize(
    ("stop", "said"),
    [({}, "names no button"), ({"chip": "/dev/gpiochip0"}, "stop.line': is missing"),
     ({"bus": "can0"}, "stop.id': is missing"), ({"chip": "c", "line": -1}, "greater than or equal to 0")],
)  # fmt: skip
def test_a_button_that_is_named_by_half_is_refused(tmp_path: Path, stop: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        config(tmp_path, [motor("m", 1)], stop=stop)


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
    with pytest.raises(InputError, match="cannot be opened"):
        Datagrams(command, half, ear.port, lambda: 0.0)
    ear.close()


@pytest.mark.parametrize("how", ["mouse", "udp:", "udp:99999", "keys"])
def test_another_way_to_ask_is_refused(how: str) -> None:
    with pytest.raises(InputError), teleoperated(how, Command(), half, lambda: 0.0):
        raise AssertionError
