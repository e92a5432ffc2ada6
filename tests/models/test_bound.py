"""What binds joints beside the tree is never left out: each loader names it, and says what to do."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.here import run
from workbench.core import InputError
from workbench.effects import load_model

_BODY = """<body name="{name}" pos="0 {y} 0"><joint name="{name}" axis="0 1 0"/>
<geom type="sphere" size="0.1"/></body>"""
_MJCF = "<mujoco><worldbody>{bodies}</worldbody>{tendons}<equality>{bound}</equality></mujoco>"
_TENDONS = '<tendon><fixed name="t"><joint joint="a" coef="1"/></fixed></tendon>'
_BOUND = {
    "connect": '<connect name="pin" body1="a" body2="b" anchor="0 0 0.1" {active}/>',
    "weld": '<weld name="pin" body1="a" body2="b" {active}/>',
    "joint": '<joint name="pin" joint1="a" joint2="b" polycoef="0 2 1 0 0" {active}/>',
    "tendon": '<tendon name="pin" tendon1="t" {active}/>',
}
_URDF = """<robot name="r"><link name="w"/><link name="l"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="a" type="revolute"><parent link="w"/><child link="l"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/>
{inside}</joint>{beside}</robot>"""


def _mjcf(folder: Path, bound: str) -> Path:
    bodies = "".join(_BODY.format(name=name, y=y) for name, y in (("a", 0), ("b", 1)))
    file = folder / "bound.xml"
    file.write_text(_MJCF.format(bodies=bodies, tendons=_TENDONS, bound=bound))
    return file


@pytest.mark.parametrize("kind", _BOUND)
def test_an_active_equality_is_named_an_inactive_does_nothing(tmp_path: Path, kind: str) -> None:
    with pytest.raises(InputError, match=rf"'pin' \({kind}\).*; ") as refusal:
        load_model(_mjcf(tmp_path, _BOUND[kind].format(active="")))
    assert "\n" not in str(refusal.value)
    assert load_model(_mjcf(tmp_path, _BOUND[kind].format(active='active="false"'))).size == 2


@pytest.mark.parametrize(
    "inside, beside, named",
    [
        ('<mimic joint="b" multiplier="-1"/>', "", "'a' follows 'b'"),
        ("", "<drake:ball_constraint><x/></drake:ball_constraint>", "ball_constraint"),
        ("", '<gazebo><joint name="back" type="revolute"/></gazebo>', "'back'"),
    ],
)
def test_a_urdf_that_says_more_than_a_tree_is_refused(
    tmp_path: Path, inside: str, beside: str, named: str
) -> None:
    (tmp_path / "r.urdf").write_text(_URDF.format(inside=inside, beside=beside))
    with pytest.raises(InputError, match=named):
        load_model(tmp_path / "r.urdf")
    (tmp_path / "r.urdf").write_text(_URDF.format(inside="", beside='<gazebo reference="l"/>'))
    assert load_model(tmp_path / "r.urdf").size == 1


@pytest.mark.parametrize(
    "command", [("check",), ("normalize", "-o", "n.xml"), ("compare", "run.toml"), ("import", "--drive", "a")]
)
def test_each_command_names_the_loop_in_one_line(tmp_path: Path, command: tuple[str, ...]) -> None:
    kind = "tendon" if command[0] == "import" else "connect"  # which takes loops, but no tendons
    file = _mjcf(tmp_path, _BOUND[kind].format(active=""))
    first, *rest = command
    done = run(first, file.name, *rest, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and f"'pin' ({kind})" in done.stderr
    assert not (tmp_path / "n.xml").exists()
