"""Every model file is read as it stands, or refused in one line that names file, key and remedy."""

from copy import deepcopy
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.data_helpers import write_toml
from tests.models.make import MACHINE_XML, leg_file, leg_table, machine_file
from workbench.core import InputError, WorkbenchError
from workbench.core.paths import models_folder
from workbench.effects import compile_plant, load_model

COULOMB = {"effect": "coulomb_friction", "axis": "knee", "parameters": {"torque": 0.2}}


def effect(**changes: Any) -> dict[str, Any]:
    entry = {**COULOMB, **changes}
    return {"effects": [{key: value for key, value in entry.items() if value is not None}]}


@pytest.mark.parametrize("name", ["leg", "leg_kin_only", "leg_s3n_act", "leg_s3n_full", "emps"])
def test_shipped_models_are_found_by_name_and_by_path(name: str) -> None:
    model = load_model(name)
    assert model.name == name
    assert load_model(models_folder() / f"{name}.toml").actuators == model.actuators
    assert load_model(f"models/{name}.toml").effects == model.effects


def test_a_file_that_is_missing_is_no_shipped_model_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("leg.toml", str(tmp_path / "leg.toml"), "sub/leg"):
        with pytest.raises(InputError, match="no such model file"):
            load_model(name)


def test_one_number_stands_for_every_axis(tmp_path: Path) -> None:
    actuators = {"inertia": 0.02, "damping": [0.1, 0.2], "delay_s": 0.001}
    model = load_model(leg_file(tmp_path, actuators=actuators))
    assert model.actuators.inertia == (0.02, 0.02)
    assert model.actuators.damping == (0.1, 0.2)
    assert model.actuators.torque_limit == (np.inf, np.inf)


#: What is changed in a good file -> words that the one line must hold.
BAD: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "unknown key": ({"colour": "red"}, ("colour",)),
    "unknown key inside": ({"actuators": {"mass": 1.0}}, ("actuators.mass", "known keys: inertia, damping")),
    "a key that is nearly there": ({"actuators": {"inerta": 1.0}}, ("did you mean 'inertia'",)),
    "a gain that pushes away": (
        {"controller": {"kind": "pd", "kp": [40.0, -40.0], "kd": [1.0, 1.0]}},
        ("'controller.kp.1': must be greater than or equal to 0, found -40.0",),
    ),
    "an unknown kind of loop": ({"controller": {"kind": "pid"}}, ("must be 'none', 'pd'", "found 'pid'")),
    "a unit of something else": (
        effect(parameters={"torque": {"value": 0.1, "unit": "furlong"}}),
        ("torque is in 'furlong'; give it in N*m",),
    ),
    "a unit of another size": (
        effect(parameters={"torque": {"value": 100.0, "unit": "mN*m"}}),
        ("torque is in 'mN*m'; give it in N*m",),
    ),
    "another format": ({"format": 2}, ("format",)),
    "no MJCF": ({"serial": "nowhere.xml"}, ("nowhere.xml", "serial", "relative")),
    "a name no system has": ({"serial": "x" * 5000}, ("serial",)),
    "an unknown variant": ({"variant": "s3n"}, ("variant", "kin_only")),
    "a variant without its linkage": ({"linkage": None}, ("variant", "[linkage]")),
    "a joint that is not there": (
        {"transmission": {"joints": ["hip", "ankle"]}},
        ("ankle", "transmission.joints", "hip, knee"),
    ),
    "one joint twice": ({"transmission": {"joints": ["hip", "hip"]}}, ("twice",)),
    "one axis twice": ({"axes": ["hip", "hip"]}, ("twice",)),
    "no joints": ({"axes": [], "transmission": {"joints": []}}, ("transmission", "square")),
    "too many axes": ({"axes": ["a", "b", "c"]}, ("transmission", "square")),
    "a singular matrix": (
        {"transmission": {"joints": ["hip", "knee"], "matrix": [[1.0, 1.0], [1.0, 1.0]]}},
        ("singular", "transmission.matrix", "independent"),
    ),
    "a matrix of zeros": (
        {"transmission": {"joints": ["hip", "knee"], "matrix": [[0.0, 0.0], [0.0, 0.0]]}},
        ("singular", "transmission.matrix"),
    ),
    "a ragged matrix": (
        {"transmission": {"joints": ["hip", "knee"], "matrix": [[1.0], [1.0, 1.0]]}},
        ("transmission", "square"),
    ),
    "an empty matrix": (
        {"transmission": {"joints": ["hip", "knee"], "matrix": []}},
        ("transmission", "square"),
    ),
    "one value too many": ({"actuators": {"inertia": [1.0, 1.0, 1.0]}}, ("actuators.inertia", "3", "2")),
    "a negative inertia": ({"actuators": {"inertia": -0.1}}, ("actuators.inertia",)),
    "an endless delay": ({"actuators": {"delay_s": float("inf")}}, ("actuators.delay_s",)),
    "an inertia that is no number": ({"actuators": {"inertia": float("nan")}}, ("actuators.inertia",)),
    "gains for one axis of two": (
        {"controller": {"kind": "pd", "kp": [1.0], "kd": [1.0]}},
        ("controller.kp", "give one per axis"),
    ),
    "a loop without gains": ({"controller": {"kind": "pd", "kp": 5.0}}, ("controller.kd", "give")),
    "a payload at no site": ({"payload": {"site": "toe"}}, ("toe", "payload.site", "foot")),
    "an unknown effect": (effect(effect="magic"), ("magic", "choose one of", "coulomb_friction")),
    "an effect that is nearly there": (effect(effect="coulomb_frictoin"), ("did you mean coulomb_friction",)),
    "a recording": ({"serial": None, "table": "run.csv"}, ("is a recording", "the model comes first")),
    "an effect on no axis": (effect(axis=None), ("coulomb_friction@hip",)),
    "an effect on an unknown axis": (effect(axis="ankle"), ("ankle", "hip, knee")),
    "an effect on an axis instead of all": (
        effect(effect="command_delay", parameters={"time": 0.001}),
        ("all axes", "@knee"),
    ),
    "an effect in a wrong place": (
        effect(effect="torque_bias", location="joint"),
        ("torque_bias", "joint", "actuator"),
    ),
    "an unknown parameter": (effect(parameters={"torque": 0.1, "heat": 1.0}), ("heat", "it has torque")),
    "a missing parameter": (effect(parameters={}), ("torque=VALUE", "N*m")),
    "friction that drives": (effect(parameters={"torque": -0.1}), ("-0.1", "0 to 1e+12 N*m")),
    "a value that is no number": (effect(parameters={"torque": float("nan")}), ("effects",)),
    "less damping than none": (
        effect(effect="viscous_damping", parameters={"damping": -0.2}),
        ("-0.2", "-0.0972"),
    ),
    "less inertia than none": (
        effect(effect="reflected_inertia", parameters={"inertia": -1.0}),
        ("inertia = -1", "-0.01458"),
    ),
    "less friction at rest than in motion": (
        effect(effect="stribeck_friction", parameters={"coulomb": 0.3, "static": 0.1, "speed": 0.2}),
        ("static = 0.1",),
    ),
    "an effect that does not apply": (
        effect(effect="linkage_coriolis", axis=None, parameters={}),
        ("linkage_coriolis", "does not apply"),
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_model_is_refused_in_one_line(case: str, tmp_path: Path) -> None:
    changes, words = BAD[case]
    file = leg_file(tmp_path, **changes)
    with pytest.raises(InputError) as caught:
        load_model(file)
    text = str(caught.value)
    assert "\n" not in text
    if "choose one of" not in words:
        assert "made.toml" in text
    for word in words:
        assert word in text
    assert caught.value.remedy


_BODIES = MACHINE_XML[MACHINE_XML.index("<worldbody>") : MACHINE_XML.index("</mujoco>")]
MJCF_PARTS = {
    "a ball joint": ('type="hinge" axis="0 -1 0"/>', 'type="ball"/>', "ball"),
    "a joint without a name": ('<joint name="boom"', "<joint", "no name"),
    "a body without mass": ('size="0.05" mass="0.6"', 'size="0.05" mass="0"', "mass"),
    "a wrong element": ("<worldbody>", "<worldboy>", "MuJoCo cannot read"),
    "no bodies": (_BODIES, "", "joints"),
}


@pytest.mark.parametrize("case", MJCF_PARTS)
def test_a_bad_mjcf_is_refused_in_one_line(case: str, tmp_path: Path) -> None:
    old, new, word = MJCF_PARTS[case]
    assert old in MACHINE_XML
    (tmp_path / "bad.xml").write_text(MACHINE_XML.replace(old, new, 1))
    with pytest.raises(InputError, match=r"bad\.xml") as caught:
        load_model(tmp_path / "bad.xml")
    assert word in str(caught.value)
    assert "\n" not in str(caught.value)
    assert caught.value.remedy


def test_what_is_no_model_file_is_refused(tmp_path: Path) -> None:
    for name, content in (("a.toml", b"name = "), ("b.toml", b"\xff\xfe\x00"), ("c.xml", b"not xml")):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(InputError, match=name):
            load_model(tmp_path / name)
    with pytest.raises(InputError, match=r"no such model file.*leg_kin_only"):
        load_model(tmp_path / "absent.toml")


VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 3),
    st.floats(allow_nan=True, allow_infinity=True),
    st.text(max_size=8),
    st.lists(st.one_of(st.floats(), st.text(max_size=3)), max_size=3),
    st.lists(st.lists(st.floats(-2, 2), max_size=3), max_size=3),
    st.dictionaries(st.text(max_size=5), st.integers(), max_size=2),
)


@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_no_model_file_ends_in_another_error(data: st.DataObject, tmp_path: Path) -> None:
    """Whatever stands in the place of any value, the model loads and compiles, or one line says why not."""
    table = leg_table(**deepcopy(effect()))
    spot: Any = table
    key = data.draw(st.sampled_from(sorted(table)))
    while isinstance(spot[key], dict | list) and spot[key] and data.draw(st.booleans()):
        spot = spot[key]
        key = data.draw(st.sampled_from(sorted(spot) if isinstance(spot, dict) else range(len(spot))))
    value = data.draw(VALUES)
    if value is None:
        del spot[key]
    else:
        spot[key] = value
    file = tmp_path / "fuzzed.toml"
    file.write_text(tomli_w.dumps(table))
    try:
        compile_plant(load_model(file))
    except WorkbenchError as error:
        assert "\n" not in str(error)


def test_a_users_mjcf_is_a_model_by_itself(tmp_path: Path) -> None:
    file = machine_file(tmp_path)
    model = load_model(file)
    assert model.name == "machine"
    assert model.axes == model.joints == ("rail", "boom", "hook")
    np.testing.assert_array_equal(model.transmission, np.eye(3))
    own = mujoco.MjModel.from_xml_path(str(file))
    compiled = compile_plant(model).mujoco
    assert compiled.nu == compiled.nsensor == compiled.nkey == 0
    for name in ("dof_damping", "dof_armature", "jnt_stiffness", "qpos_spring", "body_mass", "geom_contype"):
        np.testing.assert_array_equal(getattr(compiled, name), getattr(own, name))


def test_axes_may_be_fewer_than_joints_and_in_another_order(tmp_path: Path) -> None:
    machine_file(tmp_path)
    table = {"format": 1, "name": "m", "serial": "machine.xml", "axes": ["boom", "rail"]}
    model = load_model(write_toml(tmp_path / "m.toml", table))
    assert model.joints == ("boom", "rail")
    assert compile_plant(model).mujoco.nv == 3
