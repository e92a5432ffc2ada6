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
from workbench.deployment.ports import PortNetwork, monotonic_stamp, refuse_unheard

HOUR = 3600.0
GROUP = "239.74.163.2"  # of python-can, within this computer


def on(interface: str, channel: str, folder: Path) -> CanConfig:
    content = table([motor("hip", 1)])
    content["bus"][0] |= {"interface": interface, "channel": channel}
    if interface == "udp_multicast":  # tests side by side share the group
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("", 0))
            content["bus"][0]["options"] = {"port": free.getsockname()[1]}
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
        seen, begin = [], time.monotonic()
        end = network.now() + 60.0
        while not any(not a.sent for a in seen) and network.now() < end:
            seen += network.receive(network.now() + 0.1)
        frames = {a.frame for a in seen if not a.sent}
        assert frames == {Frame(0x12345, b"x", True)}
        now = time.monotonic()
        assert all(begin - 1.0 < a.stamp < now + 1.0 for a in seen) and network.ok("can0")
    network.close()


def test_a_bus_that_cannot_be_opened_is_named(tmp_path: Path) -> None:
    for interface, said in (("workbench", "can virtual"), ("nonsense", "nonsense")):
        with pytest.raises(InputError, match=said) as caught:
            PortNetwork(on(interface, str(tmp_path / "none"), tmp_path))
        assert "bus.can0" in str(caught.value)


def in_this_kernel(interface: str) -> None:
    """Skips where the kernel has none: SocketCAN (``ip link add dev vcan0 type vcan up``), multicast."""
    try:
        if interface == "socketcan":
            with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as probe:
                probe.bind(("vcan0",))
        elif interface == "udp_multicast":
            pytest.importorskip("msgpack", reason="udp_multicast needs msgpack")
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
                here = socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0")
                probe.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, here)
                probe.sendto(b"", (GROUP, 9))
    except (OSError, AttributeError) as error:
        what = "CAN" if interface == "socketcan" else "multicast"
        pytest.skip(f"no {what} in this kernel: {error}")


@pytest.mark.parametrize(
    ("interface", "channel"),
    [("virtual", "every"), ("udp_multicast", GROUP), ("socketcan", "vcan0")],
    ids=["virtual", "udp_multicast", "socketcan"],
)
def test_every_interface_that_needs_no_hardware(tmp_path: Path, interface: str, channel: str) -> None:
    in_this_kernel(interface)
    config = on(interface, channel, tmp_path)
    host, drive, logger = PortNetwork(config), PortNetwork(config), PortNetwork(config, echo=False)
    asked, said = Frame(0x7F, b"\1\2\3"), Frame(0x1234567, b"\4", True)

    def heard(network: PortNetwork, count: int) -> list[tuple[Frame, bool]]:
        got, end = [], network.now() + 5.0
        while len(got) < count and network.now() < end:
            got += network.receive(network.now() + 0.1)
        got += network.receive(network.now() + 0.02)  # and nothing twice
        assert all(abs(a.stamp - network.now()) < 5.0 for a in got)
        return [(a.frame, a.sent) for a in got]

    try:
        assert host.send("can0", asked) and host.send("can0", asked)
        assert heard(host, 2) == [(asked, True)] * 2, "own frames come back, and are told from others'"
        assert heard(drive, 2) == [(asked, False)] * 2
        assert drive.send("can0", said)
        assert heard(host, 1) == [(said, False)] and heard(drive, 1) == [(said, True)]
        assert heard(logger, 3) == [(asked, False), (asked, False), (said, False)]
        assert host.ok("can0")
    finally:
        for network in (host, drive, logger):
            network.close()


@pytest.mark.parametrize(
    ("interface", "channel"),
    [("virtual", "flexible"), ("udp_multicast", GROUP), ("socketcan", "vcan0")],
    ids=["virtual", "udp_multicast", "socketcan"],
)
def test_flexible_frames_and_questions_on_every_interface(
    tmp_path: Path, interface: str, channel: str
) -> None:
    in_this_kernel(interface)
    config = on(interface, channel, tmp_path)
    bus = config.bus[0].model_copy(update={"data_bitrate": 5_000_000})
    config = config.model_copy(update={"bus": [bus]})
    host, drive = PortNetwork(config), PortNetwork(config)
    frames = [
        Frame(0x8001, bytes(range(48)), True, fd=True),
        Frame(0x29, b"", remote=True),
        Frame(0x7, b"\1"),
    ]
    try:
        for frame in frames:
            assert host.send("can0", frame)
        for network, own in ((host, True), (drive, False)):
            got, end = [], network.now() + 5.0
            while len(got) < 3 and network.now() < end:
                got += network.receive(network.now() + 0.1)
            assert [(a.frame, a.sent) for a in got] == [(frame, own) for frame in frames]
    finally:
        host.close()
        drive.close()


def test_a_frame_of_another_is_not_one_of_ours_that_was_lost(tmp_path: Path) -> None:
    in_this_kernel("udp_multicast")
    config = on("udp_multicast", GROUP, tmp_path)
    host, drive = PortNetwork(config), PortNetwork(config)
    try:
        own = [Frame(0x7F, bytes([k])) for k in range(3)]
        for frame in own:
            host.send("can0", frame)
        drive.send("can0", own[0])
        got, end = [], host.now() + 5.0
        while len(got) < 4 and host.now() < end:
            got += host.receive(host.now() + 0.1)
        assert [(a.frame, a.sent) for a in got] == [*((f, True) for f in own), (own[0], False)]
    finally:
        host.close()
        drive.close()


@pytest.mark.parametrize(("interface", "heard"), [("slcan", False), ("pcan", False), ("socketcan", True)])
def test_an_experiment_needs_a_bus_that_its_logger_hears(tmp_path: Path, interface: str, heard: bool) -> None:
    config = on(interface, "any", tmp_path)
    if heard:
        return refuse_unheard(config)
    with pytest.raises(InputError, match=rf"bus\.can0\.interface.*{interface} serves one process") as caught:
        refuse_unheard(config)
    assert caught.value.exit_code == 2


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
