"""Buses by python-can: stamps that no jump of a clock can move, vendor interfaces, SocketCAN."""

from __future__ import annotations

import os
import pty
import socket
import time
import tty
from pathlib import Path

import can
import pytest

from tests.can.make import motor, table, written
from workbench.can import CanConfig, Frame, load_config
from workbench.core import InputError
from workbench.deployment.ports import PortNetwork, monotonic_stamp

HOUR = 3600.0


def on(interface: str, channel: str, folder: Path) -> CanConfig:
    content = table([motor("hip", 1)])
    content["bus"][0] |= {"interface": interface, "channel": channel}
    return load_config(written(folder, content))


def test_a_stamp_is_as_old_as_it_is() -> None:
    assert monotonic_stamp(1e9 - 0.012, 1e9, 50.0) == pytest.approx(50.0 - 0.012, abs=1e-6)


@pytest.mark.parametrize("jump", [HOUR, -HOUR, -0.5])
def test_a_jump_of_the_wall_clock_changes_nothing(jump: float) -> None:
    assert monotonic_stamp(1e9, 1e9 + jump, 50.0) == 50.0


def test_any_interface_of_python_can_is_a_network(tmp_path: Path) -> None:
    network = PortNetwork(on("virtual", "ports", tmp_path))
    with can.Bus(interface="virtual", channel="ports") as other:
        assert network.send("can0", Frame(0x7F, b"\1\2\3"))
        got = other.recv(5.0)
        assert got and got.arbitration_id == 0x7F and bytes(got.data) == b"\1\2\3"
        other.send(can.Message(arbitration_id=0x12345, data=b"x"))
        seen = []
        end = network.now() + 5.0
        while not any(not a.sent for a in seen) and network.now() < end:
            seen += network.receive(network.now() + 0.1)
        frames = {a.frame for a in seen if not a.sent}
        assert frames == {Frame(0x12345, b"x", True)}
        assert all(abs(a.stamp - time.monotonic()) < 5.0 for a in seen) and network.ok("can0")
    network.close()


def test_a_bus_that_cannot_be_opened_is_named(tmp_path: Path) -> None:
    for interface, said in (("workbench", "can virtual"), ("nonsense", "nonsense")):
        with pytest.raises(InputError, match=said) as caught:
            PortNetwork(on(interface, str(tmp_path / "none"), tmp_path))
        assert "bus.can0" in str(caught.value)


def test_socketcan(tmp_path: Path) -> None:
    """Needs ``ip link add dev vcan0 type vcan && ip link set up vcan0``."""
    try:
        with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as probe:
            probe.bind(("vcan0",))
    except (OSError, AttributeError) as error:
        pytest.skip(f"no CAN in this kernel: {error}")
    network = PortNetwork(on("socketcan", "vcan0", tmp_path))
    assert network.send("can0", Frame(0x7F, b"\1"))
    got = network.receive(network.now() + 1.0)
    assert [a.frame for a in got] == [Frame(0x7F, b"\1")] and got[0].sent
    network.close()


def test_a_serial_adapter_is_a_bus(tmp_path: Path) -> None:
    pytest.importorskip("serial", reason="slcan needs pyserial")
    adapter, ours = pty.openpty()
    tty.setraw(ours)
    content = table([motor("hip", 1)])
    content["bus"][0] |= {
        "interface": "slcan", "channel": os.ttyname(ours), "options": {"sleep_after_open": 0.0},
    }  # fmt: skip
    network = PortNetwork(load_config(written(tmp_path, content)))
    try:
        assert network.send("can0", Frame(0x07F, b"\1\2\3"))
        said = b""
        while b"t07F3010203\r" not in said:
            said += os.read(adapter, 100)
        assert b"S8\r" in said and b"O\r" in said, "a megabit, opened"
        os.write(adapter, b"t0112AABB\rT0000123418F\r")
        seen, end = [], network.now() + 10.0
        while len(seen) < 2 and network.now() < end:
            seen += network.receive(network.now() + 0.1)
        assert [a.frame for a in seen] == [Frame(0x11, b"\xaa\xbb"), Frame(0x1234, b"\x8f", True)]
        assert not any(a.sent for a in seen) and all(abs(a.stamp - network.now()) < 10.0 for a in seen)
    finally:
        network.close()
        os.close(adapter)
        os.close(ours)
