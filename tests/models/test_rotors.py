"""What a drive has of its own: from the model file, and from an MJCF joint that no other drive turns."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.data_helpers import write_toml
from workbench import load_model
from workbench.effects import compile_plant
from workbench.models import own_friction, rotors

_ARM = """<mujoco><worldbody><body><joint name="a" axis="0 -1 0" armature="0.02" damping="0.3"/>
<inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
<body pos="0 0 -0.2"><joint name="b" axis="0 -1 0" armature="0.05"/>
<inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.01"/>{end}</body></body></worldbody></mujoco>"""


def test_armature_of_a_joint_is_the_rotor_that_turns_it_alone(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(_ARM.format(end=""))
    inertia, damping = rotors(load_model(str(tmp_path / "arm.xml")))
    assert inertia.tolist() == [0.02, 0.05] and damping.tolist() == [0.3, 0.0]
    model = {
        "format": 1, "name": "arm", "serial": "arm.xml", "axes": ["first", "second"],
        "transmission": {"joints": ["b", "a"], "matrix": [[2.0, 0.0], [0.0, 1.0]]},
        "actuators": {"inertia": [0.001, 0.0], "damping": [0.1, 0.2]},
    }  # fmt: skip
    inertia, damping = rotors(load_model(str(write_toml(tmp_path / "geared.toml", model))))
    assert np.allclose(inertia, [0.001 + 0.05 / 4, 0.02]) and np.allclose(damping, [0.1, 0.5])


def test_where_drives_share_a_joint_its_armature_is_nobodys(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(_ARM.format(end=""))
    model = {
        "format": 1, "name": "arm", "serial": "arm.xml",
        "transmission": {"joints": ["a", "b"], "matrix": [[1.0, 0.0], [1.0, 1.0]]},
        "actuators": {"inertia": 0.004},
    }  # fmt: skip
    assert rotors(load_model(str(write_toml(tmp_path / "leg.toml", model))))[0].tolist() == [0.004, 0.004]


def test_a_payload_hangs_at_the_only_site_at_the_end(tmp_path: Path) -> None:
    found = []
    for name, end in (
        ("one", '<site name="tool"/>'),
        ("none", ""),
        ("two", '<site name="x"/><site name="y"/>'),
    ):
        (tmp_path / f"{name}.xml").write_text(_ARM.format(end=end))
        found.append(load_model(str(tmp_path / f"{name}.xml")).payload_site)
    assert found == ["tool", None, None]


_COUPLED = _ARM.replace(
    "</worldbody>",
    """</worldbody><tendon>
<fixed name="one" armature="0.01" damping="0.2" frictionloss="0.3"><joint joint="a" coef="1"/></fixed>
<fixed name="both" armature="0.04" damping="0.1" frictionloss="0.6">
<joint joint="a" coef="2"/><joint joint="b" coef="2"/></fixed>
<fixed name="neither" armature="0.7">
<joint joint="a" coef="1"/><joint joint="b" coef="3"/></fixed></tendon>""",
)
_DRIVES = {
    "format": 1, "name": "leg", "serial": "leg.xml", "axes": ["thigh", "shank"],
    "transmission": {"joints": ["a", "b"], "matrix": [[1.0, 0.0], [1.0, 1.0]]},
}  # fmt: skip


def test_the_numbers_of_a_tendon_that_is_a_drive_are_the_drives(tmp_path: Path) -> None:
    (tmp_path / "leg.xml").write_text(_COUPLED.format(end=""))
    model = load_model(str(write_toml(tmp_path / "leg.toml", _DRIVES)))
    inertia, damping = rotors(model)
    assert np.allclose(inertia, [0.01, 4 * 0.04]) and np.allclose(damping, [0.2, 4 * 0.1])
    friction = {str(e.key): e.values["torque"] for e in own_friction(model)}
    assert friction == pytest.approx({"coulomb_friction@thigh": 0.3, "coulomb_friction@shank": 1.2})


def test_the_machine_is_the_one_that_the_file_states(tmp_path: Path) -> None:
    (tmp_path / "leg.xml").write_text(_COUPLED.format(end=""))
    made = compile_plant(load_model(str(write_toml(tmp_path / "leg.toml", _DRIVES)))).mujoco
    stated = mujoco.MjModel.from_xml_path(str(tmp_path / "leg.xml"))
    rows = []
    for m in (made, stated):
        data = mujoco.MjData(m)
        data.qpos[:], data.qvel[:] = (0.3, -0.7), (1.1, 0.4)
        mujoco.mj_forward(m, data)
        mujoco.mj_fullM(m, data, mass := np.zeros((2, 2)))
        rows.append((mass, data.qfrc_bias.copy(), data.qfrc_passive.copy()))
    for one, other in zip(*rows, strict=True):
        assert np.allclose(one, other, rtol=1e-12)
