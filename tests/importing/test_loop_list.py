"""Loops of a URDF that a YAML file beside it lists."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.cli.here import run
from workbench.core import InputError
from workbench.importing import contents_of
from workbench.models import read_model
from workbench.verification import verify

_INERTIA = '<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/>'
# name, parent, joint, its place, axis, mass, inertia
_LINKS = (
    ("thigh", "base", "hip", "0 0 0", "0 -1 0", 0.9, 0.004),
    ("shank", "thigh", "knee", "0 0 -0.22", "0 -1 0", 0.35, 0.002),
    ("lever", "base", "motor", "0 0 0", "0 -1 0", 0.1, 1e-4),
    ("rod", "lever", "ball", "0 0 0.045", "0 -1 0", 0.07, 3e-4),
)


def _robot(folder: Path, text: str, name: str = "robot") -> Path:
    parts = ['<link name="base"/>']
    for link, parent, joint, at, axis, mass, about in _LINKS:
        parts += [
            f'<link name="{link}"><visual><geometry><mesh filename="package://gone.stl"/></geometry></visual>'
            f'<inertial><origin xyz="0 0 -0.1"/><mass value="{mass}"/>{_INERTIA.format(i=about)}</inertial>',
            "</link>",
            f'<joint name="{joint}" type="revolute"><parent link="{parent}"/><child link="{link}"/>'
            f'<origin xyz="{at}"/><axis xyz="{axis}"/><limit effort="1" velocity="20" lower="-2" upper="2"/>',
            "</joint>",
        ]
    for joint, link, z in (("loop_A", "rod", -0.2), ("loop_B", "shank", 0.05), ("sole", "shank", -0.24)):
        parts.append(
            f'<link name="{joint}_link"/><joint name="{joint}" type="fixed"><parent link="{link}"/>'
            f'<child link="{joint}_link"/><origin xyz="0 0 {z}"/></joint>'
        )
    file = folder / "robot.urdf"
    file.write_text(f'<robot name="r">{"".join(parts)}</robot>')
    (folder / f"{name}.yaml").write_text(text)
    return file


_LIST = "closed_loop: [['loop_A', 'loop_B']]\ntype: ['3d']\nname_mot: ['hip', 'motor']\n"
_WORDS = [
    *("--drive", "hip", "--drive", "motor", "--joint", "hip", "--joint", "knee", "--foot", "sole_link"),
    *("--limits", "hip=-0.6:0.6", "--limits", "knee=0.6:1.6", "--start", "knee=1"),
]


@pytest.mark.parametrize(
    "text",
    [
        _LIST,
        _LIST + "joint_name: ['ball', 'of_the_other_half']\njoint_type: ['UJOINT_ZY', 'SPHERICAL']\n",
    ],
    ids=["a pin", "a universal joint"],
)
def test_the_list_closes_the_loops(tmp_path: Path, text: str) -> None:
    file = _robot(tmp_path, text, "loops")  # the only list in the folder
    told = contents_of(file)
    assert told.motors == ("hip", "motor") and "loops.yaml" in str(told) and told.loops == 1
    done = run("import", file, *_WORDS, "--rotor-inertia", 0.01, "-o", tmp_path / "own.toml")
    assert done.returncode == 0, done.stderr
    model = read_model(tmp_path / "own.toml")
    assert model.posture_dependent and "mesh" not in (tmp_path / "own.urdf").read_text()
    assert verify(model, samples=4).passed


def test_a_list_and_loop_options_are_one_mechanism(tmp_path: Path) -> None:
    file = _robot(tmp_path, _LIST)
    assert run("import", file, *_WORDS, "-o", tmp_path / "listed.toml").returncode == 0
    (tmp_path / "robot.yaml").unlink()
    words = [*_WORDS, "--loop", "loop_A_link:loop_B_link"]
    assert run("import", file, *words, "-o", tmp_path / "named.toml").returncode == 0
    listed, named = (read_model(tmp_path / f"{n}.toml").transmission for n in ("listed", "named"))
    np.testing.assert_allclose(listed, named, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("closed_loop: [['loop_A', 'nowhere']]\n", "'nowhere' is not a frame"),
        ("closed_loop: [['loop_A', 'loop_B']]\ntype: ['4d']\n", "type.0"),
        ("closed_loop: [['loop_A', 'loop_B']]\ntype: ['3d', '3d']\n", "2 entries for 1"),
        (_LIST + "joint_name: ['ball']\njoint_type: ['SLIDER']\n", "'SLIDER'"),
        (_LIST.replace("'motor'", "'gone'"), "'gone' is not a joint"),
        ("closed_loop: [['loop_A'\n", "no YAML"),
    ],
)
def test_what_is_wrong_is_said_of_the_list(tmp_path: Path, text: str, told: str) -> None:
    file = _robot(tmp_path, text)
    with pytest.raises(InputError) as raised:
        contents_of(file)
    assert told in str(raised.value) and "robot.yaml" in str(raised.value)
