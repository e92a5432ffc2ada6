"""Bad input ends ``workbench ui`` before anything is served: one line, exit code 2."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from tests.data_helpers import write_recording
from workbench.cli.ui import ui
from workbench.core import InputError

pytest.importorskip("panel")


def refused(model: object, *recordings: object, port: int = 0) -> str:
    with pytest.raises(InputError) as error:
        ui(str(model), [str(r) for r in recordings], port=port, browser=False)
    assert error.value.exit_code == 2 and "\n" not in str(error.value)
    return str(error.value)


def test_bad_files_are_named(tmp_path: Path) -> None:
    broken = tmp_path / "broken.toml"
    broken.write_text("name = [")
    assert "not a TOML file" in refused(broken)
    assert "no such model file" in refused(tmp_path / "gone.toml")
    assert "gone.toml" in refused("leg", tmp_path / "gone.toml")
    recording = write_recording(tmp_path)
    assert "axes" in refused("leg", recording)
    assert "twice" in refused("leg", recording, recording)
    assert "is a recording, not a model" in refused(recording)


def test_a_port_that_is_taken_is_said_to_be() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        assert "port" in refused("leg", port=taken.getsockname()[1])
