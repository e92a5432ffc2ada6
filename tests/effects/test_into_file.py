"""What was found stands in the user's own file: MuJoCo alone then makes the true machine of it."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.bench_arm import NUMBERS, bench_arm
from workbench.core import EffectKey, Estimate
from workbench.effects import check_effect, into_file, load_model
from workbench.models import AppliedEffect, Model

DRY = {"yaw": 0.3, "lift": 0.5}
WRONG = {"lift_damping": 0.5, "yaw_armature": 0.15, "upper_centre": 0.15, "fore_inertia": 0.02}


def with_effects(file: Path, *effects: tuple[str, dict[str, float]]) -> Model:
    """A model with effects as ``name@axis`` or ``name@axis(joint)`` and their values."""
    model = load_model(file)
    for place, values in effects:
        name, _, axis = place.partition("@")
        at = "joint" if axis.endswith("(joint)") else "actuator"
        key = EffectKey(name, axis.removesuffix("(joint)") or None, at)
        applied = AppliedEffect(key, {k: Estimate(v, 0.0, "") for k, v in values.items()})
        model = model.with_effect(check_effect(model, applied))
    return model


def corrections() -> list[tuple[str, dict[str, float]]]:
    """From the wrong numbers to the true ones."""
    lack = {name: NUMBERS[name] - value for name, value in WRONG.items()}
    return [
        ("viscous_damping@lift", {"damping": lack["lift_damping"]}),
        ("reflected_inertia@yaw", {"inertia": lack["yaw_armature"]}),
        ("first_moment_error@lift", {"along": NUMBERS["upper_mass"] * lack["upper_centre"], "across": 0.0}),
        ("link_inertia_error@bend", {"inertia": lack["fore_inertia"]}),
        *((f"coulomb_friction@{axis}", {"torque": 0.25 * dry}) for axis, dry in DRY.items()),
        *((f"coulomb_friction@{axis}", {"torque": 0.75 * dry}) for axis, dry in DRY.items()),
    ]


def true(folder: Path) -> Path:
    """The true machine, where only the moment about the forearm's hinge is other than that of the file."""
    file = bench_arm(folder, "true")
    text = file.read_text()
    turn = NUMBERS["fore_inertia"] - WRONG["fore_inertia"]
    text = re.sub(r'diaginertia="0.014 \S+ 0.032"', f'diaginertia="0.014 {0.02 + turn} 0.02"', text)
    for axis, dry in DRY.items():
        text = text.replace(f'<joint name="{axis}"', f'<joint name="{axis}" frictionloss="{dry}"')
    file.write_text(text)
    return file


def machine(m: mujoco.MjModel) -> list[np.ndarray]:
    """Numbers of the joints, and what postures and speeds ask of them."""
    data, generator = mujoco.MjData(m), np.random.default_rng(3)
    rows = [m.dof_damping, m.dof_armature, m.dof_frictionloss, m.jnt_stiffness, m.body_mass, m.body_ipos]
    for _ in range(5):
        data.qpos[:], data.qvel[:] = generator.normal(size=m.nq), generator.normal(size=m.nv)
        mujoco.mj_forward(m, data)
        mujoco.mj_fullM(m, data, mass := np.zeros((m.nv, m.nv)))
        rows += [mass, data.qfrc_bias.copy(), data.qfrc_passive.copy()]
    return rows


def same(one: Path, other: Path) -> None:
    pairs = zip(*(machine(mujoco.MjModel.from_xml_path(str(f))) for f in (one, other)), strict=True)
    for a, b in pairs:
        assert a == pytest.approx(b, rel=1e-9, abs=1e-9)


FORMS = {
    "diaginertia": r"\g<0>",
    "full": r'pos="\1" mass="\2" fullinertia="\3 \4 \5 0 0 0"',
    "turned about the hinge": r'\g<0> quat="1 0 0 0"',
    "axes swapped": r'pos="\1" mass="\2" diaginertia="\3 \5 \4" euler="1.5707963267948966 0 0"',
}


@pytest.mark.parametrize("form", FORMS)
def test_the_true_machine_comes_of_a_file_with_wrong_numbers(form: str, tmp_path: Path) -> None:
    file = bench_arm(tmp_path, **WRONG)
    text = re.sub(
        r'pos="([^"]+)" mass="([^"]+)"\s+diaginertia="(\S+) (\S+) (\S+)"', FORMS[form], file.read_text()
    )
    file.write_text(text)
    made = into_file(with_effects(file, *corrections()), file)
    assert not made.left
    fixed = tmp_path / "fixed.xml"
    fixed.write_bytes(made.content)
    same(fixed, true(tmp_path))
    assert ("quat" in made.content.decode()) == (form == "turned about the hinge")


def test_an_inertia_that_is_turned_gets_a_quaternion(tmp_path: Path) -> None:
    file = bench_arm(tmp_path)
    file.write_text(file.read_text().replace('0.032 0.032"', "0.032 0.028\" euler='0.4 0 0'"))
    made = into_file(with_effects(file, ("link_inertia_error@bend", {"inertia": 0.004})), file)
    assert b"euler" not in made.content and b"quat='" in made.content
    before, after = (mujoco.MjModel.from_xml_string(t) for t in (file.read_text(), made.content.decode()))
    body, y = before.body("fore").id, np.array([0.0, 1.0, 0.0])

    def about(m: mujoco.MjModel) -> np.ndarray:
        mujoco.mju_quat2Mat(axes := np.zeros(9), m.body_iquat[body])
        axes = axes.reshape(3, 3)
        return axes @ np.diag(m.body_inertia[body]) @ axes.T

    assert about(after) - about(before) == pytest.approx(0.004 * np.outer(y, y), abs=1e-12)


OWN = b"""\xef\xbb\xbf<?xml version="1.0"?>\r
<!-- M\xc3\xbcller's arm; <joint name="lift" damping="7"/> -->\r
<mujoco model='arm'>\r
  <default><joint damping="0.5"   armature='0.05'/>\r
    <default class="big"><joint damping="0.9 0.01" frictionloss="0.2" springref="10"/></default>\r
  </default>\r
  <worldbody>\r
    <body name="upper" pos="0 0 1" childclass="big">\r
      <joint   name='lift'  axis="0 1 0"\r
               range="-90 90" /> <!-- from the data sheet -->\r
      <inertial mass="2" pos="0 0 -0.15" diaginertia="0.02 0.02 0.002"/>\r
      <body name="fore" pos="0 0 -0.3">\r
\t<joint name="bend" class="main" axis="0 1 0" damping='.5'></joint>\r
        <geom type="capsule" size="0.03" fromto="0 0 0 0 0 -0.2" mass="1"/>\r
      </body>\r
    </body>\r
  </worldbody>\r
  <equality><joint name="lift" joint1="lift" active="false"/></equality>\r
</mujoco>\r
"""


def test_all_else_in_the_file_stays_byte_for_byte(tmp_path: Path) -> None:
    file = tmp_path / "own.xml"
    file.write_bytes(OWN)
    model = with_effects(
        file,
        ("viscous_damping@lift", {"damping": -0.4}),
        ("viscous_damping@bend", {"damping": -0.5}),
        ("coulomb_friction@lift", {"torque": 0.05}),
        ("parallel_spring@bend", {"stiffness": 1.0, "rest": 0.25 * np.pi}),
        ("parallel_spring@bend", {"stiffness": 1.0, "rest": 0.75 * np.pi}),
        ("first_moment_error@bend", {"along": 0.01, "across": 0.0}),
    )
    after = into_file(model, file).content.split(b"\n")
    before = OWN.split(b"\n")
    new = [line for line in after if line not in before]
    assert [line for line in after if line in before] == [
        line for line in before if b"range=" not in line and b'"bend"' not in line
    ]
    joint = b'<joint name="bend" class="main" axis="0 1 0"'
    assert new == [
        b'               range="-90 90" damping="0.5" frictionloss="0.25" /> <!-- from the data sheet -->\r',
        b"\t" + joint + b" damping='0' stiffness='2' springref='90'></joint>\r",
        new[2],
    ]
    assert new[2].startswith(b'\t<inertial pos="0 0 -0.11" mass="1" fullinertia="0.00')


URDF = """<?xml version='1.0'?>
<robot name="arm"><link name="base"/>
  <link name="upper"><visual><geometry><mesh filename="package://a/b.stl"/></geometry></visual>
    <inertial><origin xyz="0 0 -0.15" rpy="0.3 0.2 -0.1"/><mass value="2"/>
      <inertia ixx="0.02" iyy="0.021" izz="0.002" ixy="0" ixz="0.001" iyz="0"/></inertial></link>
  <link name="fore"><inertial><mass value="1"/><inertia ixx="6e-3" iyy="6e-3" izz="1e-3" ixy="0"
     ixz="0" iyz="0"/></inertial></link>
  <joint name="lift" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <dynamics damping="0.8"/></joint>
  <joint name="bend" type="continuous">
    <parent link="upper"/><child link="fore"/><origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/>
  </joint>
  <transmission name="t"><joint name="lift"/></transmission>
</robot>
"""


def test_a_urdf_gets_what_it_has_a_place_for(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(URDF)
    model = with_effects(
        file,
        ("viscous_damping@lift", {"damping": -0.3}),
        ("coulomb_friction@lift", {"torque": 0.2}),
        ("coulomb_friction@bend", {"torque": 0.1}),
        ("viscous_damping@bend", {"damping": 0.2}),
        ("reflected_inertia@bend", {"inertia": 0.02}),
        ("link_inertia_error@bend", {"inertia": 0.001}),
        ("first_moment_error@bend", {"along": 0.0, "across": 0.03}),
        ("first_moment_error@lift", {"along": 0.1, "across": 0.0}),
    )
    made = into_file(model, file)
    assert [e.key.effect for e in made.left] == ["reflected_inertia"]
    before, after = URDF.split("\n"), made.content.decode().split("\n")
    new = [line for line in after if line not in before]
    assert '    <dynamics damping="0.5" friction="0.2"/></joint>' in new
    behind = '    <parent link="upper"/><child link="fore"/><origin xyz="0 0 -0.3"/><axis xyz="0 1 0"/>'
    assert after[after.index(behind + '<dynamics friction="0.1" damping="0.2"/>') + 1] == "  </joint>"
    assert (
        '      <inertia ixx="0.02" iyy="0.021" izz="0.002" ixy="0" ixz="0.001" iyz="0"/></inertial></link>'
        in after
    )
    assert 'iyy="0.007"' in made.content.decode() and 'xyz="' in made.content.decode()


COUPLED = """<mujoco><worldbody><body><joint name="a" axis="0 1 0"/><geom size="0.1"/>
<body pos="0 0 -0.3"><joint name="b" axis="0 1 0"/><geom size="0.1"/></body></body></worldbody>
<tendon><fixed name="m1" armature="0.02" frictionloss="0.2"><joint joint="a" coef="1"/></fixed>
  <fixed name="belt" armature="0.03"  damping='0.5'><joint joint="a" coef="2"/>
    <joint joint="b" coef="2"/></fixed>
</tendon><actuator><motor name="m1" tendon="m1"/><motor name="m2" tendon="belt"/></actuator></mujoco>"""


def test_too_much_at_a_drive_of_two_joints_comes_off_its_tendon(tmp_path: Path) -> None:
    file = tmp_path / "leg.xml"
    file.write_text(COUPLED)
    less = ("reflected_inertia@m2", {"inertia": -0.004}), ("viscous_damping@m2", {"damping": -0.1})
    made = into_file(with_effects(file, *less, ("coulomb_friction@m1", {"torque": -0.15})), file)
    wanted = COUPLED.replace('"0.2"', '"0.05"').replace('"0.03"', '"0.026"').replace("'0.5'", "'0.4'")
    assert made.content.decode() == wanted and not made.left
