"""``workbench show``: a page with the robot moving, of a policy or a recording."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np

from tests.cli.here import run

_LEG = Path(__file__).parents[2] / "policies" / "reach_s3n_full.zip"


def _data(page: Path) -> dict:
    found = re.search(
        r'<script type="application/json" id="data">(.*?)</script>', page.read_text(), re.DOTALL
    )
    assert found
    return json.loads(found[1])


def test_a_policy_moves_and_its_curves_are_beside_it(tmp_path: Path) -> None:
    done = run("show", _LEG, "--seconds", 1.5, "-o", tmp_path / "page.html")
    assert done.returncode == 0, done.stderr
    data = _data(tmp_path / "page.html")
    ends = np.array(data["ends"]).reshape(len(data["time"]), -1, 2, 3)
    assert len(data["time"]) > 30 and np.ptp(ends, axis=0).max() > 0.02
    assert np.allclose(np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=-1).std(axis=0), 0.0, atol=1e-3)
    titles = [panel["title"] for panel in data["panels"]]
    assert titles[:2] == ["hip: position [rad]", "hip: torque [N m]"]
    words = (tmp_path / "page.html").read_text()
    assert "hip RMSE" in words and "_rmse_" not in words, "no key of the JSON"


def test_a_recording_needs_its_model(tmp_path: Path) -> None:
    assert run("record", "leg", "slow", "-o", tmp_path).returncode == 0
    alone = run("show", tmp_path / "slow.toml", "-o", tmp_path / "page.html")
    assert alone.returncode == 2 and "--model" in alone.stderr
    other = run("show", tmp_path / "slow.toml", "--model", "ur10e", "-o", tmp_path / "page.html")
    assert other.returncode == 2 and "axes" in other.stderr
    done = run("show", tmp_path / "slow.toml", "--model", "leg", "-o", tmp_path / "page.html")
    assert done.returncode == 0 and _data(tmp_path / "page.html")["panels"]


def test_a_film_needs_ffmpeg(tmp_path: Path) -> None:
    words = ["show", _LEG, "--seconds", 1.5, "-o", tmp_path / "page.html", "--mp4", tmp_path / "film.mp4"]
    done = run(*words)
    if shutil.which("ffmpeg"):
        assert done.returncode == 0 and (tmp_path / "film.mp4").stat().st_size > 1000
    else:
        assert done.returncode == 2 and "ffmpeg is not installed" in done.stderr
