"""A tree with a free joint: six axes that no drive moves, which are the free joint's own coordinates."""

from __future__ import annotations

from dataclasses import fields, replace

import mujoco
import numpy as np
import pytest

from tests import floating_robot
from workbench.comparison.floating import with_base
from workbench.core import InputError, Recording
from workbench.effects import load_model, places
from workbench.models import BASE_AXES, load_tree, write_model
from workbench.s3n import normalise
from workbench.verification import verify

DRIVEN = floating_robot.AXES


@pytest.fixture
def folder(tmp_path):
    floating_robot.write_robot(tmp_path)
    return tmp_path


def test_a_base_that_floats_has_axes_and_no_drives(folder) -> None:
    model = load_model(folder / "robot.toml")
    assert model.axes == (*DRIVEN, *BASE_AXES) and model.driven == DRIVEN and model.floats
    assert {key.axis for key in places(model)} == {None, *DRIVEN}
    write_model(model, folder / "again.toml")
    text = (folder / "again.toml").read_text()
    again = replace(load_model(folder / "again.toml"), source=model.source)
    assert "base_x" not in text
    np.testing.assert_array_equal(again.transmission, np.eye(len(DRIVEN) + 6))
    same = [f.name for f in fields(model) if f.name != "transmission"]
    assert [getattr(again, name) for name in same] == [getattr(model, name) for name in same]


def test_the_six_coordinates_are_those_of_the_free_joint(folder) -> None:
    free = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    split = load_tree(folder / "robot.xml").compile()
    one, other = mujoco.MjData(free), mujoco.MjData(split)
    generator = np.random.default_rng(5)
    quaternion = np.array([0.8, 0.3, -0.35, 0.4])
    one.qpos[:3], one.qpos[3:7] = (0.3, -0.2, 0.6), quaternion / np.linalg.norm(quaternion)
    one.qpos[7:] = generator.uniform(-1, 1, len(DRIVEN))
    one.qvel[:] = generator.uniform(-1, 1, free.nv)
    recording = Recording(
        "one", DRIVEN, "actuator", np.arange(3) * 1e-3,
        {"position": np.tile(one.qpos[7:], (3, 1)), "velocity": np.tile(one.qvel[6:], (3, 1))},
        ("rad",) * len(DRIVEN),
        extra={
            "base_position": np.tile(one.qpos[:3], (3, 1)),
            "base_orientation": np.tile(one.qpos[3:7], (3, 1)),
            "base_velocity": np.tile(one.qvel[:3], (3, 1)),
            "base_angular_velocity": np.tile(one.qvel[3:6], (3, 1)),
        },
    )  # fmt: skip
    seen = with_base(recording, load_model(folder / "robot.toml"))
    assert with_base(seen, load_model(folder / "robot.toml")) is seen
    for i, axis in enumerate(seen.axes):
        joint = split.joint(axis)
        other.qpos[joint.qposadr[0]], other.qvel[joint.dofadr[0]] = seen.position[0, i], seen.velocity[0, i]
    for m, data in ((free, one), (split, other)):
        mujoco.mj_forward(m, data)
        mujoco.mj_energyPos(m, data)
        mujoco.mj_energyVel(m, data)
    np.testing.assert_allclose(other.xpos, one.xpos, atol=1e-12)
    np.testing.assert_allclose(other.xmat, one.xmat, atol=1e-12)
    np.testing.assert_allclose(other.energy, one.energy, rtol=1e-12)
    np.testing.assert_allclose(other.cvel, one.cvel, atol=1e-9)


def test_what_no_model_can_be_is_told(folder) -> None:
    xml = (folder / "robot.xml").read_text()
    wrong = {
        "bodies 'trunk', 'box' all float": xml.replace(
            "</worldbody>", '<body name="box"><freejoint/><geom size="0.1"/></body></worldbody>'
        ),
        "body 'fl_bracket' floats inside of another": xml.replace("<freejoint/>", "").replace(
            '<joint name="fl_roll" axis="1 0 0" armature="0.01"/>', "<freejoint/>"
        ),
        "joint 'base_x' has the name of an axis of the base": xml.replace('"fl_knee"', '"base_x"'),
        "joint 'fl_hip' is a ball": xml.replace('name="fl_hip" axis="0 1 0"', 'name="fl_hip" type="ball"'),
    }
    for line, text in wrong.items():
        (folder / "robot.xml").write_text(text)
        with pytest.raises(InputError, match=line):
            load_model(folder / "robot.toml")


def test_what_is_for_machines_on_a_stand_says_so(folder) -> None:
    model = load_model(folder / "robot.toml")
    for asked in (verify, normalise):
        with pytest.raises(InputError, match="takes one that is fixed; take the <freejoint/> out"):
            asked(model)


def test_a_joint_that_is_called_as_an_axis_of_a_base_is_a_joint(tmp_path) -> None:
    """Many an arm turns about its "base_yaw", and stood for a robot that floats."""
    (tmp_path / "arm.xml").write_text(
        """<mujoco><worldbody><body name="column"><joint name="base_yaw" axis="0 0 1"/><geom size="0.1"/>
        <body name="arm" pos="0 0 0.3"><joint name="lift" axis="0 1 0"/><geom size="0.1"/></body></body>
        </worldbody></mujoco>"""
    )
    model = load_model(tmp_path / "arm.xml")
    assert not model.floats and model.axes == model.driven == ("base_yaw", "lift")
    assert verify(model).passed
