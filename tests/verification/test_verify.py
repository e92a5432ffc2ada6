"""A right model passes; a model with one thing wrong fails with that thing named."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.core import Verification
from workbench.core.paths import models_folder
from workbench.models import read_model
from workbench.verification import verify

PAPER = {
    "kin_only": (0.04058, 0.00232, 0.01852),
    "s3n_act": (0.05678, 0.01852, 0.01852),
    "s3n_full": (0.07161, 0.02368, 0.02368),
    "s3n_full_paper": (0.07161, 0.02368, 0.02368),
    "exact": (0.07161, 0.02368, 0.02368),
}


def broken(
    folder: Path,
    *changes: tuple[str, str],
    tree: tuple[str, str] | None = None,
    sdf: tuple[str, str] = ("", ""),
) -> Verification:
    """The reference leg with words replaced in its TOML, MJCF or SDF, checked."""
    shipped = models_folder()
    toml, mjcf = (shipped / "leg.toml").read_text(), (shipped / "serial/leg.xml").read_text()
    chain = (shipped / "closed_chain/leg.sdf").read_text()
    for old, new in changes:
        assert old in toml
        toml = toml.replace(old, new)
    if tree:
        assert tree[0] in mjcf
        mjcf = mjcf.replace(*tree)
    if sdf:
        assert sdf[0] in chain
        chain = chain.replace(*sdf)
    for name, text in (("serial/leg.xml", mjcf), ("closed_chain/leg.sdf", chain), ("leg.toml", toml)):
        file = folder / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(text)
    return verify(read_model(folder / "leg.toml"), samples=12)


def failures(result: Verification) -> set[str]:
    return {check.name for check in result.checks if not check.passed}


@pytest.fixture(scope="module")
def leg() -> Verification:
    return verify(read_model("leg"), samples=40)


def test_the_reference_leg_agrees_in_every_engine(leg: Verification) -> None:
    assert leg.passed, failures(leg)
    exact = {c.name: c.value for c in leg.checks}
    assert max(exact[name] for name in ("mass_matrix", "gravity", "coriolis")) < 1e-9


def test_a_shell_prints_the_verdict_and_a_line_per_quantity(leg: Verification) -> None:
    lines = repr(leg).splitlines()
    assert lines[0] == f"leg: all {len(leg.checks)} quantities agree." and len(lines) == len(leg.checks) + 2
    broken = replace(leg, checks=(replace(leg.checks[0], value=0.2), *leg.checks[1:]))
    assert "FAIL  forward kinematics" in repr(broken) and "disagree" in broken._repr_html_()


def test_the_papers_table_to_all_printed_digits(leg: Verification) -> None:
    assert {name: tuple(np.round(m, 5)) for name, m in leg.variants.items()} == PAPER


def test_the_radius_of_explicit_injection(leg: Verification) -> None:
    assert leg.alpha_deg[0] == 0 and leg.alpha_deg[-1] == 180
    assert (round(leg.radius[0], 3), round(leg.radius[-1], 3)) == (0.895, 0.831)


@pytest.mark.parametrize("name", ["leg_kin_only", "leg_s3n_act", "leg_s3n_full"])
def test_every_shipped_variant_passes(name: str) -> None:
    assert verify(read_model(name), samples=5).passed


def test_without_a_closed_chain_two_engines_are_left() -> None:
    result = verify(read_model("emps"), samples=5)
    assert result.passed
    assert any("closed chain" in line for line in result.not_checked)


def test_a_free_base_that_cannot_be_looked_at_is_said(leg: Verification, tmp_path: Path) -> None:
    turned = '<pose rotation_format="quat_xyzw">0 0 -0.08 0 0 0 1</pose>'  # which Drake alone reads
    result = broken(tmp_path, sdf=("<pose>0 0 -0.08 0 0 0</pose>", turned))
    assert result.passed, failures(result)
    assert "free_base_mass" in leg.facts and not leg.not_checked and not result.facts
    (line,) = result.not_checked
    assert line.startswith("the exact variant on a free base: ") and "leg.sdf" in line


def test_a_wrong_sign_in_the_transmission(tmp_path: Path) -> None:
    result = broken(tmp_path, ("matrix = [[1.0, 0.0], [1.0, 1.0]]", "matrix = [[1.0, 0.0], [-1.0, 1.0]]"))
    assert failures(result) == {"transmission"}
    assert "drive 'knee'" in next(c.hint for c in result.checks if not c.passed)


def test_a_wrong_axis_in_the_tree(tmp_path: Path) -> None:
    result = broken(
        tmp_path, tree=('name="knee" type="hinge" axis="0 -1 0"', 'name="knee" type="hinge" axis="0 1 0"')
    )
    assert {"forward_kinematics", "jacobian"} <= failures(result)


def test_a_wrong_length_in_the_tree(tmp_path: Path) -> None:
    assert "forward_kinematics" in failures(broken(tmp_path, tree=('pos="0 0 -0.175"', 'pos="0 0 -0.176"')))


def test_a_wrong_length_in_the_linkage(tmp_path: Path) -> None:
    longer = '<frame name="coupler_end" attached_to="coupler"><pose>0 0 -0.175'
    bent = 'foot = "foot"\nstart = {hip = -0.5, knee = 1.2, crank_pin = 0.7, coupler_pin = -1.2}'
    result = broken(tmp_path, ('foot = "foot"', bent), sdf=(longer, longer.replace("0.175", "0.18")))
    assert failures(result) == {"transmission"}
    assert "posture_dependent" in next(c.hint for c in result.checks if not c.passed)


def test_the_actuator_counted_twice_as_armature(tmp_path: Path) -> None:
    result = broken(tmp_path, tree=('<joint name="hip" ', '<joint name="hip" armature="0.0162" '))
    assert "actuator_inertia" in failures(result)
    assert "counted twice" in next(c.hint for c in result.checks if c.name == "actuator_inertia")


def test_the_actuator_counted_twice_in_the_linkage(tmp_path: Path) -> None:
    result = broken(tmp_path, ("M11 = 0.00967", "M11 = 0.02587"))
    assert "linkage_inertia" in failures(result) and "actuator_inertia" not in failures(result)
    assert "counted twice" in next(c.hint for c in result.checks if c.name == "linkage_inertia")


def test_a_wrong_weight(tmp_path: Path) -> None:
    result = broken(tmp_path, ("g2 = 0.132743314285714", "g2 = -0.132743314285714"))
    assert {"linkage_gravity", "gravity"} <= failures(result)
    assert "linkage_inertia" not in failures(result)


def test_identified_numbers_may_differ_by_what_is_allowed(tmp_path: Path) -> None:
    shipped = models_folder() / "leg.toml"
    file = tmp_path / "leg.toml"
    file.write_text(shipped.read_text().replace("M22 = 0.00516", "M22 = 0.00520"))
    model = read_model(file)
    assert not verify(model, samples=5).passed
    assert verify(model, samples=5, tolerance=0.01).passed


def test_velocity_terms_of_a_balanced_link_are_no_breach(tmp_path: Path) -> None:
    """A link whose mass lies on its axis has no velocity terms: what rounding leaves of them is none."""
    (tmp_path / "wheel.xml").write_text(
        """<mujoco><worldbody><body name="arm"><joint name="arm" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.02"/><body name="wheel" pos="0 0 -0.2">
<joint name="wheel" axis="0 1 0"/><geom size="0.03"/></body></body></worldbody></mujoco>"""
    )
    assert verify(read_model(tmp_path / "wheel.xml"), samples=12).passed
