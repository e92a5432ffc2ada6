"""What a URDF or SDF states as effort is the torque limit of a drive, as that of a motor of an MJCF is."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import pytest

from tests.cli.here import run
from tests.importing.leg_urdf import urdf_of_a_leg
from workbench.core import InputError
from workbench.importing import contents_of
from workbench.importing.efforts import efforts_in
from workbench.importing.mjcf_bonds import torque_limit
from workbench.models import read_model

_WORDS = [
    *("--drive", "hip", "--drive", "motor", "--joint", "hip", "--joint", "knee"),
    *("--loop", "rod_end:arm_end", "--foot", "toe", "-o", "own.toml"),
]


def _said(text: str) -> dict[str, float]:
    root = ElementTree.fromstring(f"<robot><joint name='hip'>{text}</joint></robot>")
    return efforts_in(root, Path("own.urdf"))


@pytest.mark.parametrize("text", ["<limit effort='24'/>", "<axis><limit><effort>24</effort></limit></axis>"])
def test_an_effort_is_a_limit_in_urdf_and_in_sdf(text: str) -> None:
    assert _said(text) == {"hip": 24.0}


@pytest.mark.parametrize(
    "text", ["", "<limit lower='-1'/>", *(f"<limit effort='{x}'/>" for x in ("0", "-1", "inf"))]
)
def test_zero_and_less_are_no_limit(text: str) -> None:
    assert _said(text) == {}


def test_an_effort_in_letters_is_refused() -> None:
    with pytest.raises(InputError, match="joint 'hip' has an effort of 'much'"):
        _said("<limit effort='much'/>")


@pytest.mark.parametrize(("more", "limits"), [([], [21.0, 17.0]), (["--torque-limit", "9"], [9.0, 9.0])])
def test_import_takes_efforts_unless_others_are_given(
    tmp_path: Path, more: list[str], limits: list[float]
) -> None:
    text = urdf_of_a_leg().replace('effort="20"', 'effort="21"', 1).replace('effort="20"', 'effort="17"', 1)
    (tmp_path / "own.urdf").write_text(text)
    done = run("import", "own.urdf", *_WORDS, *more, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert list(read_model(tmp_path / "own.toml").actuators.torque_limit) == limits
    told = "Torque limits of the drives, from the file: hip 21, motor 17. --torque-limit states others."
    assert (told in done.stdout) == (not more)


def test_a_file_without_efforts_gives_drives_without_limit(tmp_path: Path) -> None:
    (tmp_path / "own.urdf").write_text(urdf_of_a_leg().replace('effort="20"', 'effort="0"'))
    assert contents_of(tmp_path / "own.urdf").torque_limit == {}
    done = run("import", "own.urdf", *_WORDS, "--json", "own.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "Torque limits" not in done.stdout and json.loads((tmp_path / "own.json").read_text())["files"]
    assert list(read_model(tmp_path / "own.toml").actuators.torque_limit) == [float("inf")] * 2


@pytest.mark.parametrize(
    ("joint", "motor", "limit"),
    [
        ("", "", float("inf")),
        ('actuatorfrcrange="-30 30"', "", 30.0),
        ('actuatorfrcrange="-30 30"', 'gear="2" ctrlrange="-10 10"', 20.0),
        ('actuatorfrcrange="-15 15"', 'gear="2" ctrlrange="-10 10"', 15.0),
        ('actuatorfrcrange="-15 20"', 'forcerange="-12 12"', 12.0),
    ],
)
def test_of_the_limits_of_motor_and_joint_the_lower_one(joint: str, motor: str, limit: float) -> None:
    m = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler autolimits="true"/><worldbody><body><joint name="hip" {joint}/><geom size="0.1"/>'
        f'</body></worldbody><actuator><motor joint="hip" {motor}/></actuator></mujoco>'
    )
    assert torque_limit(m, 0) == limit
