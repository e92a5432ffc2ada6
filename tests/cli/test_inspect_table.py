"""``workbench inspect``: what is said of several axes stands in one line, and a warning is no note."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.cli.here import run
from tests.proposing.make import columns, log, text

LOG = log(1200)


def recorded(folder: Path, limit: float) -> None:
    """A log, its command clipped at a share of its largest value, and its recording."""
    data = columns(LOG)
    for joint in ("hip", "knee"):
        name = f"cmd_torque_{joint}"
        most = limit * np.abs(data[name]).max()
        noise = data[f"torque_{joint}"] - data[name]
        data[name] = np.clip(data[name], -most, most)
        data[f"torque_{joint}"] = data[name] + noise
    (folder / "run.csv").write_text(text(data))
    assert run("import", "run.csv", "-q", cwd=folder).returncode == 0


def test_what_is_said_of_every_axis_is_said_once(tmp_path: Path) -> None:
    recorded(tmp_path, 1.0)
    shown = run("inspect", "run.toml", cwd=tmp_path, columns=200).stdout
    (line,) = [line for line in shown.splitlines() if "too few frequencies" in line]
    assert "hip, knee" in line and "The command of each has too few frequencies" in line
    (line,) = [line for line in shown.splitlines() if "derivative of its position" in line]
    assert "hip, knee" in line and "Velocity of each is" in line


@pytest.mark.parametrize(("limit", "code"), [(1.0, 0), (0.6, 1)])
def test_a_warning_ends_as_the_help_says(limit: float, code: int, tmp_path: Path) -> None:
    recorded(tmp_path, limit)
    done = run("inspect", "run.toml", cwd=tmp_path, columns=200)
    assert done.returncode == code, done.stdout
    assert ("warning" in done.stdout) == bool(code) and "problem" not in done.stdout
    helped = " ".join(run("inspect", "--help", columns=200).stdout.split())
    assert "Exit code 1 where something is wrong with them or may be: at a problem or a warning" in helped
