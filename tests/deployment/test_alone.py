"""One host a bus, however the other one ends."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.can.make import motor, table, written
from workbench.can import load_config
from workbench.core import InputError
from workbench.deployment.alone import alone

HOLD = """
import sys, time
from workbench.can import load_config
from workbench.deployment.alone import alone
with alone(load_config(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def robot(folder: Path, *channels: str) -> Path:
    names = tuple(f"can{k}" for k in range(len(channels)))
    content = table([motor(f"m{k}", 1, bus=name) for k, name in enumerate(names)], names)
    for bus, channel in zip(content["bus"], channels, strict=True):
        bus["channel"] = channel
    folder.mkdir(exist_ok=True)
    return written(folder, content)


def test_a_second_host_is_refused_until_the_first_is_killed(tmp_path: Path) -> None:
    shared = str(tmp_path / "shared.sock")
    first = robot(tmp_path / "a", str(tmp_path / "own.sock"), shared)
    (tmp_path / "link").symlink_to(tmp_path)
    second = load_config(robot(tmp_path / "b", str(tmp_path / "link" / "shared.sock")))
    other = subprocess.Popen([sys.executable, "-c", HOLD, str(first)], stdout=subprocess.PIPE, text=True)
    try:
        assert other.stdout and other.stdout.readline().strip() == "held"
        with pytest.raises(InputError, match=r"bus\.can0.*commanded by another process"), alone(second):
            raise AssertionError
    finally:
        other.send_signal(signal.SIGKILL)
        other.communicate()
    with alone(second):
        pass
    with alone(second), pytest.raises(InputError), alone(second):
        raise AssertionError
