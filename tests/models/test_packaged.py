"""Robots by name, from packages that have the interface of robot_descriptions and mujoco_menagerie."""

import sys
from pathlib import Path

import pytest

from tests.cli.here import run
from tests.models.make import MACHINE_XML
from workbench.core import InputError
from workbench.effects import load_model

URDF = """<robot name="arm"><link name="base"/><link name="rod"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="pin" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""

HERE = "from os import path\nhere = path.join(path.dirname(__file__), 'arm')\n"
NAMES = "arm_mj_description", "arm_description", "lost", "xacro_only"
DESCRIPTIONS = {
    "__init__": f"DESCRIPTIONS = dict.fromkeys({NAMES})",
    "arm_mj_description": f"{HERE}print('Cloning ...')\nMJCF_PATH = path.join(here, 'machine.xml')",
    "arm_description": f"{HERE}URDF_PATH = path.join(here, 'arm.urdf')",
    "lost": "raise OSError('no route to host')",
    "xacro_only": "XACRO_PATH = 'arm.urdf.xacro'",
}
MENAGERIE = """
import pathlib
class Robot:
    default_model, default_scene = "machine", "scene"
    def xml(self, entry=None):
        return pathlib.Path(__file__).parent / "arm" / f"{entry or self.default_scene}.xml"
def names():
    return ["maker_arm"]
def get(name):
    return {"maker_arm": Robot()}[name]
"""


@pytest.fixture(autouse=True)
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for package, files in {
        "robot_descriptions": DESCRIPTIONS,
        "mujoco_menagerie": {"__init__": MENAGERIE},
    }.items():
        robots = tmp_path / package / "arm"
        robots.mkdir(parents=True)
        (robots / "machine.xml").write_text(MACHINE_XML)
        (robots / "arm.urdf").write_text(URDF)
        for name, text in files.items():
            (tmp_path / package / f"{name}.py").write_text(text)
    for name in [n for n in sys.modules if n.split(".")[0] in ("robot_descriptions", "mujoco_menagerie")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.syspath_prepend(tmp_path)


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("robot_descriptions:arm_mj_description", "robot_descriptions/arm/machine.xml"),
        ("robot_descriptions:arm_description", "robot_descriptions/arm/arm.urdf"),
        ("mujoco_menagerie:maker_arm", "mujoco_menagerie/arm/machine.xml"),
    ],
)
def test_a_packaged_robot_is_the_model_of_its_file(
    name: str, file: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model, same = load_model(name), load_model(tmp_path / file)
    assert (model.name, model.axes, model.source) == (same.name, same.axes, tmp_path / file)
    assert capsys.readouterr().out == ""  # downloads are told elsewhere than results


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "robot_descriptions:arm_mj_descripton",
            "no robot 'arm_mj_descripton'; did you mean arm_mj_description",
        ),
        ("robot_descriptions:", "it has arm_description, arm_mj_description, lost, xacro_only"),
        (
            "robot_descriptions:lost",
            "no route to host; robot_descriptions downloads a robot at its first use",
        ),
        ("robot_descriptions:xacro_only", "neither an MJCF nor a URDF"),
        ("mujoco_menagerie:maker_leg", "did you mean maker_arm"),
    ],
)
def test_a_robot_that_cannot_be_had_is_refused_in_one_line(name: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        load_model(name)
    assert words in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["robot_descriptions:arm_description", "mujoco_menagerie:maker_arm"])
def test_a_package_that_is_not_there_is_named(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, name.partition(":")[0], None)
    with pytest.raises(InputError, match=r"install it: pip install (robot_descriptions|mujoco-menagerie)$"):
        load_model(name)


def test_a_file_of_that_name_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mujoco_menagerie:own.xml").write_text(MACHINE_XML)
    assert load_model("mujoco_menagerie:own.xml").source == Path("mujoco_menagerie:own.xml")


def test_import_lists_a_robot_by_its_name(tmp_path: Path) -> None:
    """What has loops has to go through import, which took names for files."""
    done = run("import", "robot_descriptions:arm_description", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "joints: pin" in done.stdout
