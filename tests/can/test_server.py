"""The bus between processes, through python-can; here server and nodes are threads of one process."""

from __future__ import annotations

import importlib
import threading
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path

import can
import pytest

from tests.can.make import config, motor
from workbench.can import Frame
from workbench.can.packets import pack, unpack
from workbench.can.plugin import WorkbenchBus
from workbench.can.server import serve
from workbench.core import InputError

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def channel(tmp_path: Path) -> Iterator[str]:
    path = str(tmp_path / "bus")
    loaded = config(tmp_path, [motor("hip", 1)]).model_copy(deep=True)
    bus = loaded.bus[0].model_copy(update={"channel": path})
    loaded, over, ready = loaded.model_copy(update={"bus": [bus]}), threading.Event(), threading.Event()
    thread = threading.Thread(target=serve, args=(loaded, over.is_set, ready.set))
    thread.start()
    assert ready.wait(60.0)
    yield path
    over.set()
    thread.join()
    assert not Path(path).exists()


def message(id: int, data: bytes = b"\1\2", extended: bool = False) -> can.Message:
    return can.Message(arbitration_id=id, data=data, is_extended_id=extended)


def test_what_one_sends_all_others_get_and_the_sender_its_echo(channel: str) -> None:
    with (
        WorkbenchBus(channel, receive_own_messages=True) as one,
        WorkbenchBus(channel) as two,
        WorkbenchBus(channel) as three,
    ):
        begin = time.monotonic()
        one.send(message(0x12345, b"abcdefgh", extended=True))
        echo, got, also = one.recv(5.0), two.recv(5.0), three.recv(5.0)
        assert echo and got and also and not echo.is_rx and got.is_rx and also.is_rx
        assert got.arbitration_id == 0x12345 and got.is_extended_id and bytes(got.data) == b"abcdefgh"
        assert echo.timestamp - one.shift == pytest.approx(got.timestamp - two.shift, abs=1e-6)
        assert begin - 0.01 <= two.monotonic(got.timestamp) <= time.monotonic() + 0.01
        two.send(message(1))
        assert (answer := one.recv(5.0)) and answer.arbitration_id == 1 and two.recv(0.05) is None


def test_a_bus_that_nobody_serves_is_no_bus(tmp_path: Path) -> None:
    with pytest.raises(can.exceptions.CanInitializationError, match="no bus at"):
        WorkbenchBus(str(tmp_path / "none"))


def test_a_node_that_is_gone_holds_up_nobody(channel: str) -> None:
    with WorkbenchBus(channel) as one, WorkbenchBus(channel) as two:
        WorkbenchBus(channel).shutdown()
        WorkbenchBus(channel)._socket.close()
        one.send(message(5))
        assert (got := two.recv(5.0)) and got.arbitration_id == 5


def test_too_many_frames_at_once_are_refused_and_counted(channel: str) -> None:
    with WorkbenchBus(channel) as one, WorkbenchBus(channel) as two:
        for _ in range(200):
            one.send(message(5, bytes(8)))
        end = time.monotonic() + 60.0
        got = 0
        while got < 32 and time.monotonic() < end:
            got += two.recv(0.1) is not None
        one.recv(0.1)
        assert 32 <= got <= 200 and one.refused > 0


def test_a_living_bus_is_not_replaced_and_a_dead_one_is(channel: str, tmp_path: Path) -> None:
    loaded = config(tmp_path, [motor("hip", 1)])
    bus = loaded.bus[0].model_copy(update={"channel": channel})
    with pytest.raises(InputError, match="another process serves"):
        serve(loaded.model_copy(update={"bus": [bus]}), lambda: True)


def test_packets_carry_frames() -> None:
    for frame in (Frame(0x7FF, b""), Frame(0x1FFFFFFF, b"12345678", True)):
        assert unpack(pack(b"S", 1.5, frame)) == (b"S", 1.5, frame)
    with pytest.raises(ValueError, match="bytes"):
        unpack(b"x")


def test_the_interface_is_registered_with_python_can() -> None:
    points = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]["can.interface"]
    module, name = points["workbench"].split(":")
    assert getattr(importlib.import_module(module), name) is WorkbenchBus
