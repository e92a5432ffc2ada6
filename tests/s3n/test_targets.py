"""A file for each simulator: what it cannot have is not in it and named, and the rest is the same machine."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

from tests.cli.here import run
from workbench.cli import complete
from workbench.core import InputError
from workbench.effects import load_model
from workbench.models import load_mjcf
from workbench.s3n import compiled_dynamics, normalise
from workbench.s3n.targets import TARGETS, for_target

_Q = np.array([[-0.4, 1.2], [0.3, 0.7]])
_V = np.array([[2.0, -1.0], [0.5, 3.0]])


def test_targets_are_named_where_completion_reads_them() -> None:
    assert tuple(TARGETS) == complete.TARGETS
    with pytest.raises(InputError, match="no target is called 'bullet'; choose one of mujoco, "):
        for_target("<mujoco/>", "bullet")


@pytest.mark.parametrize("target", ["mujoco3", "mjlab", "newton"])
def test_only_what_is_named_is_lost(target: str) -> None:
    whole = normalise(load_model("leg"), "exact")
    fitted = for_target(whole.xml, target)
    assert 'delay="' in whole.xml and 'delay="' not in fitted.text and "nsample" not in fitted.text
    assert {"motor hip: delay 0.003 s", "motor knee: delay 0.003 s"} <= set(fitted.lost)
    one, other = (compiled_dynamics(mujoco.MjModel.from_xml_string(x), ("hip", "knee"), _Q, _V)
                  for x in (whole.xml, fitted.text))  # fmt: skip
    for key, value in vars(one).items():
        np.testing.assert_array_equal(getattr(other, key), value, err_msg=key)
    comment = next(node for node in ElementTree.fromstring(
        fitted.text, ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    ).iter() if callable(node.tag))  # fmt: skip
    assert "exact" in (comment.text or "") or "leg" in (comment.text or "")


def test_springs_and_damping_that_are_no_lines_are_named() -> None:
    xml = (
        '<mujoco><worldbody><body><joint name="j" damping="0.1 0.02 0" stiffness="3 0 1"/>'
        '<geom size="0.1"/></body></worldbody></mujoco>'
    )
    fitted = for_target(xml, "newton")
    assert 'damping="0.1"' in fitted.text and 'stiffness="3"' in fitted.text
    assert fitted.lost == (
        "joint j: damping beyond the linear (0.02 0)", "joint j: stiffness beyond the linear (0 1)"
    )  # fmt: skip
    assert for_target(xml, "mujoco").text == xml


_ROUNDED = """<mujoco><worldbody>
<body gravcomp="1e-15"><joint name="j" damping="0.1 1e-17" stiffness="0 0 1e-16" armature="1e-18"/>
<inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/></body></worldbody><tendon>
<fixed name="t" armature="2e-19" stiffness="{stiffness}" damping="1e-18 {damping}">
<joint joint="j" coef="1"/></fixed></tendon></mujoco>"""


@pytest.mark.parametrize("target", ["mujoco3", "mjlab", "newton", "urdf"])
def test_rounding_is_no_loss(target: str) -> None:
    assert for_target(_ROUNDED.format(stiffness="0", damping="0"), target).lost == ()
    real = for_target(_ROUNDED.format(stiffness="0.2", damping="0.03"), target).lost
    linear = ("tendon t: stiffness 0.2",) if target == "urdf" else ()
    assert real == ("tendon t: damping beyond the linear (0.03)", *linear)


def test_a_rotor_on_a_spatial_tendon_is_lost_elsewhere_too() -> None:
    xml = (
        '<mujoco><worldbody><site name="a" pos="0 0 1"/><body><joint name="j"/><geom size="0.1"/>'
        '<inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/><site name="b"/></body></worldbody>'
        '<tendon><spatial name="s" armature="0.02"><site site="a"/><site site="b"/></spatial></tendon>'
        "</mujoco>"
    )
    assert for_target(xml, "newton").lost == ("tendon s: armature 0.02, in solvers other than MuJoCo's",)


def test_a_urdf_has_the_links_and_names_every_rotor(tmp_path: Path) -> None:
    json_file = tmp_path / "n.json"
    words = ["normalize", "leg", "-o", tmp_path / "leg.urdf", "--for", "urdf", "--json", json_file]
    done = run(*words, "--variant", "s3n_full")
    assert done.returncode == 0, done.stderr
    told = json.loads(json_file.read_text())["for"]
    assert told["target"] == "urdf"
    assert "joint hip: rotor inertia (armature) 0.0162" in told["lost"] and "this is lost" in done.stdout
    assert any(each.startswith("tendon knee: inertia 0.0162") for each in told["lost"])
    # the links are those of the MJCF once everything that is named is taken out of it
    whole = mujoco.MjModel.from_xml_string(normalise(load_model("leg"), "s3n_full").xml)
    for field in (whole.dof_armature, whole.tendon_armature, whole.tendon_damping, whole.body_gravcomp):
        field[:] = 0.0
    read = load_mjcf(tmp_path / "leg.urdf").compile()
    one, other = (compiled_dynamics(m, ("hip", "knee"), _Q, _V) for m in (whole, read))
    for key in ("mass", "bias", "gravity"):
        np.testing.assert_allclose(getattr(other, key), getattr(one, key), atol=1e-9, err_msg=key)


def test_the_ten_lines_for_mjlab_map_joints_to_drives() -> None:
    """tau_drive = tau_joint @ inv(J) is J^-T tau_joint, row by row."""
    model = load_model("leg")
    said = "\n".join(for_target(normalise(model, "exact").xml, "mjlab").advice)
    assert "tau_joint @ inv_J" in said and "round(0.003 / timestep)" in said and "('hip', 'knee')" in said
    tau, inv = np.array([[1.0, 2.0]]), np.linalg.inv(model.transmission)
    np.testing.assert_allclose((tau @ inv)[0], np.linalg.inv(model.transmission.T) @ tau[0])
    assert len(said.splitlines()) <= 11
