"""What a run leaves on the disk where no second process can hear the bus: nothing, and that is said."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.can.make import motor, table, written
from workbench.cli.app import app
from workbench.core import InputError


@pytest.fixture
def alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A leg on a bus that one process has for itself; nobody answers there."""
    content = table([motor("hip", 1)])
    content["bus"][0] |= {"interface": "virtual", "channel": str(tmp_path)}
    file = written(tmp_path, content)
    monkeypatch.chdir(tmp_path)
    return file


def test_a_run_goes_on_and_is_not_kept(alone: Path) -> None:
    there = set(alone.parent.iterdir())
    done = CliRunner().invoke(app, ["deploy", "tracker", str(alone), "--yes", "--seconds", "1"])
    assert "not recorded: virtual serves one process at a time" in done.stderr
    assert "does not answer" in str(done.exception) and set(alone.parent.iterdir()) == there


def test_a_folder_that_was_asked_for_is_refused_unmade(alone: Path) -> None:
    done = CliRunner().invoke(app, ["deploy", "tracker", str(alone), "--yes", "-o", "kept"])
    assert isinstance(done.exception, InputError) and "serves one process" in str(done.exception)
    assert not (alone.parent / "kept").exists()
