"""A URDF with meshes that nobody has, as people have them: its inertias are all that counts."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from workbench.core import InputError
from workbench.effects import compile_plant, load_model
from workbench.models import own_friction

_LINK = """<link name="{name}"><inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>
<inertia ixx="0.02" iyy="0.03" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="package://robot/meshes/{name}.dae"/></geometry></visual>
<collision><geometry><mesh filename="package://robot/meshes/{name}.stl"/></geometry></collision></link>"""
_ARM = f"""<?xml version="1.0"?><robot name="arm"><material name="grey"><color rgba="1 1 1 1"/></material>
<link name="base"/>{_LINK.format(name="upper", z=-0.2, mass=2.0)}
{_LINK.format(name="lower", z=-0.1, mass=1.0)}
<link name="tool"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 1"/>
<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="50" velocity="3"/>
<dynamics damping="0.4" friction="0.7"/>
</joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.4"/>
<axis xyz="0 1 0"/></joint>
<joint name="mount" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="0 0 -0.3"/></joint>
<gazebo reference="upper"><plugin name="p" filename="libp.so"/></gazebo>
<transmission name="t"><joint name="shoulder"/></transmission></robot>"""
_MJCF = """<mujoco><worldbody><body name="upper" pos="0 0 1"><joint name="shoulder" axis="0 1 0" damping="0.4"
frictionloss="0.7" range="-114.591559026 114.591559026"/>
<inertial pos="0 0 -0.2" mass="2" diaginertia="0.02 0.03 0.01"/>
<body name="lower" pos="0 0 -0.4"><joint name="elbow" axis="0 1 0"/><inertial pos="0 0 -0.1" mass="1"
diaginertia="0.02 0.03 0.01"/></body></body></worldbody></mujoco>"""


def _written(folder: Path, text: str, name: str = "arm.urdf") -> Path:
    file = folder / name
    file.write_text(text)
    return file


def test_a_urdf_is_the_arm_that_an_mjcf_describes(tmp_path: Path) -> None:
    model = load_model(_written(tmp_path, _ARM))
    assert model.axes == ("shoulder", "elbow")
    ours, theirs = (
        compile_plant(m).mujoco for m in (model, load_model(_written(tmp_path, _MJCF, "same.xml")))
    )
    for m in (ours, theirs):
        m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    made = []
    for m in (ours, theirs):
        d = mujoco.MjData(m)
        d.qpos[:], d.qvel[:], d.qacc[:] = [0.3, -0.8], [1.1, -0.6], [2.0, 3.0]
        mujoco.mj_inverse(m, d)
        made.append(d.qfrc_inverse.copy())
    assert np.allclose(made[0], made[1], rtol=1e-9)


def test_the_last_link_is_where_a_payload_hangs(tmp_path: Path) -> None:
    assert load_model(_written(tmp_path, _ARM)).payload_site == "tool"


def test_a_model_file_may_name_a_urdf(tmp_path: Path) -> None:
    _written(tmp_path, _ARM)
    table = 'format = 1\nname = "arm"\nserial = "arm.urdf"\n[actuators]\ninertia = 0.1\n'
    model = load_model(_written(tmp_path, table, "arm.toml"))
    assert model.actuators.inertia == (0.1, 0.1)
    assert tmp_path / "arm.urdf" in model.files


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (_ARM.replace("robot", "sdf"), "a URDF is a <robot>"),
        (_ARM.replace('value="2.0"', 'value="${mass}"'), "xacro"),
        (_ARM.replace('value="2.0"', 'value="${mass}"'), "'\\$\\{mass}' in link 'upper'"),
        (_ARM.replace('<link name="base"/>', '<link name="base"/><xacro:foot/>'), "<xacro:foot>"),
        (_ARM.replace('ixx="0.02"', 'ixx="0.2"'), 'balanceinertia="true"/> in <mujoco>'),
        (_ARM.replace("<robot", "<!DOCTYPE x><robot"), "document type"),
        (_ARM.replace('type="revolute"', 'type="floating"'), "floats inside of another"),
        (_ARM.replace('<mass value="1.0"/>', '<mass value="-1.0"/>'), "MuJoCo cannot"),
        (_ARM[:400], "no XML"),
    ],
)
def test_what_is_no_urdf_of_an_arm_is_refused_in_one_line(text: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told) as error:
        load_model(_written(tmp_path, text))
    assert "\n" not in str(error.value)


def test_macros_in_what_is_not_read_do_no_harm(tmp_path: Path) -> None:
    left = "<!-- <xacro:foot mass='${mass}'/>\n -->"
    text = _ARM.replace("</robot>", f'{left}<gazebo reference="${{name}}_link"/></robot>')
    text = text.replace("<visual><geometry>", '<visual name="${name}"><geometry>')
    assert load_model(_written(tmp_path, text)).axes == ("shoulder", "elbow")


def test_a_urdf_may_ask_mujoco_to_mend_its_inertias(tmp_path: Path) -> None:
    wrong = _ARM.replace('ixx="0.02"', 'ixx="0.2"')
    asked = '<mujoco><compiler meshdir="m" balanceinertia="true"/></mujoco></robot>'
    plant = compile_plant(load_model(_written(tmp_path, wrong.replace("</robot>", asked))))
    assert np.allclose(np.ptp(plant.mujoco.body_inertia[-3:-1], axis=1), 0.0)


def test_its_joints_friction_is_dry_friction(tmp_path: Path) -> None:
    one, other = (load_model(_written(tmp_path, t, n)) for t, n in ((_ARM, "arm.urdf"), (_MJCF, "same.xml")))
    assert own_friction(one) == own_friction(other)
    assert [(str(e.key), e.values) for e in own_friction(one)] == [
        ("coulomb_friction@shoulder", {"torque": 0.7})
    ]
