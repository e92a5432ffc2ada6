"""Ranges of a file that go on past dead points, or that it has not: what a model of it takes."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.cli.here import run
from workbench.models import read_model
from workbench.verification import verify

# an unequal four-bar, whose knee can be bent but not stretched
_LEG = """<mujoco><compiler angle="radian" autolimits="true"/><worldbody>
<body name="thigh"><joint name="hip" axis="0 -1 0" {hip} armature="0.02"/>
<inertial pos="0.01 0 -0.13" mass="1.4" diaginertia="0.009 0.009 0.001"/>
<body name="shin" pos="0 0 -0.31"><joint name="knee" axis="0 -1 0" {knee}/>
<inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.004 0.004 0.0004"/><site name="toe" pos="0 0 -0.29"/>
</body><body name="crank" pos="0.02 0 -0.03"><joint name="crank" axis="0 -1 0" armature="0.015"/>
<inertial pos="0 0 0.02" mass="0.12" diaginertia="1e-4 1e-4 1e-5"/>
<body name="rod" pos="0 0 0.055"><joint name="pin" axis="0 -1 0"/>
<inertial pos="0 0 -0.15" mass="0.09" diaginertia="8e-4 8e-4 1e-5"/></body></body></body></worldbody>
<equality><connect body1="rod" body2="shin" anchor="0 0 -0.29"/></equality></mujoco>"""
_WORDS = [
    *("--drive", "hip", "--drive", "crank", "--joint", "hip", "--joint", "knee", "--foot", "toe"),
    *("--start", "knee=1"),
]
_RANGES = 'range="-0.9 0.9"', 'range="-0.3 2.8"'


def _imported(folder: Path, hip: str, knee: str, *more: str) -> tuple[str, Path]:
    file = folder / "strange.xml"
    file.write_text(_LEG.format(hip=hip, knee=knee))
    done = run("import", file, *_WORDS, *more, "-o", folder / "own.toml", "--json", folder / "own.json")
    assert done.returncode == 0, done.stderr
    return " ".join(done.stdout.split()), folder / "own.toml"


@pytest.fixture(scope="module")
def narrowed(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """What is said of a leg whose range goes on past a dead point, and its model."""
    return _imported(tmp_path_factory.mktemp("narrowed"), *_RANGES)


def test_a_range_past_a_dead_point_is_narrowed_and_told(narrowed: tuple[str, Path]) -> None:
    said, file = narrowed
    model = read_model(file)
    assert model.closed_chain is not None
    hip, knee = model.closed_chain.limits
    assert hip == (-0.9, 0.9) and 0.6 < knee[0] < 1.2 and knee[1] == 2.8
    assert (
        f"Limits: hip -0.9 to 0.9, knee {knee[0]:g} to 2.8; left out of the file's: knee from -0.3 to" in said
    )
    assert "--limits JOINT=LOW:HIGH" in said
    told = json.loads(file.with_suffix(".json").read_text())
    assert told["limits"] == [list(hip), list(knee)] and "near a dead point" in told["limits_changed"][0]
    assert verify(model, samples=5).passed


def test_limits_that_the_user_gives_are_taken_as_they_are(tmp_path: Path) -> None:
    said, file = _imported(tmp_path, *_RANGES, "--limits", "knee=1.1:2.4")
    model = read_model(file)
    assert model.closed_chain is not None and model.closed_chain.limits == ((-0.9, 0.9), (1.1, 2.4))
    assert "Limits:" not in said


def test_where_the_file_has_no_range_one_about_start_is_taken(tmp_path: Path) -> None:
    said, file = _imported(tmp_path, "", "")
    model = read_model(file)
    assert model.closed_chain is not None and len(model.closed_chain.limits) == 2
    assert "the file states none, these are about the start posture" in said
    result = verify(model, samples=5)
    assert result.passed and not any("limits" in line for line in result.not_checked)


@pytest.mark.parametrize("knee", [-0.3, 0.2])
def test_check_leaves_out_what_is_not_reached_and_passes(
    narrowed: tuple[str, Path], tmp_path: Path, knee: float
) -> None:
    shutil.copytree(narrowed[1].parent, tmp_path, dirs_exist_ok=True)
    file = tmp_path / narrowed[1].name
    model = read_model(file)
    assert model.closed_chain is not None
    text = file.read_text()
    low = model.closed_chain.limits[1][0]
    file.write_text(text.replace(f"[{low:g}, 2.8]", f"[{knee}, 2.8]"))
    done = run("check", file)
    assert done.returncode == 0, done.stdout
    assert f"Not checked: knee from {knee:g} to " in " ".join(done.stdout.split())
