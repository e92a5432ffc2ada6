"""Mechanisms whose transmission depends on the posture pass; with one thing wrong, that thing is named."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.importing.leg_urdf import urdf_of_a_leg
from workbench.core import Check, Coupling, InputError, Mechanism, Verification
from workbench.core.paths import models_folder
from workbench.importing import Drives, import_model
from workbench.models import read_model
from workbench.verification import verify
from workbench.verification.posture import posture_checks
from workbench.verification.subject import Subject


def made(folder: Path, *changes: tuple[str, str, str]) -> Path:
    """The five-bar with words replaced in one of its files (``toml``, ``xml`` or ``sdf``)."""
    shipped = models_folder()
    files = {
        "toml": "five_bar.toml", "xml": "serial/five_bar.xml", "sdf": "closed_chain/five_bar.sdf",
    }  # fmt: skip
    texts = {kind: (shipped / name).read_text() for kind, name in files.items()}
    for kind, old, new in changes:
        assert old in texts[kind]
        texts[kind] = texts[kind].replace(old, new)
    for kind, name in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(texts[kind])
    return folder / "five_bar.toml"


def failures(checks: tuple[Check, ...] | list[Check]) -> set[str]:
    return {check.name for check in checks if not check.passed}


def broken(folder: Path, *changes: tuple[str, str, str]) -> Verification:
    return verify(read_model(made(folder, *changes)), samples=8)


def against_another(folder: Path, *changes: tuple[str, str, str]) -> set[str]:
    """What fails when our engine reads a file that differs from Drake's."""
    subject = Subject.of(read_model("five_bar"), 8, 0, 1e-9)
    return failures(posture_checks(replace(subject, model=read_model(made(folder, *changes))), 0))


def test_the_five_bar_agrees_in_every_engine() -> None:
    result = verify(read_model("five_bar"), samples=12)
    assert result.passed, failures(result.checks)
    exact = {c.name: c.value for c in result.checks}
    names = ("mass_matrix", "coriolis", "gravity", "jacobian", "drives")
    assert max(exact[f"posture_{name}"] for name in names) < 1e-9
    assert 0.1 < result.facts["fitted_inertia_max"][0] < 5.0
    about = [fact for name, (_, _, fact) in result.facts.items() if name.startswith("fitted_")]
    assert about and all(fact.endswith(" is") for fact in about), "a number and its unit follow"
    assert not result.variants and not result.not_checked


def test_one_drive_of_constant_inertia_has_no_velocity_terms(tmp_path: Path) -> None:
    """The knee of a parallelogram with its hip held: what is left of its velocity terms is rounding."""
    file = tmp_path / "leg.urdf"
    file.write_text(urdf_of_a_leg(0.2, {"knee": (0.5, 2.4), "motor": (-2.0, 3.0)}))
    loop, held = (("rod_end", "arm_end"),), (Coupling("hip", None, (0.0,)),)
    mechanism = Mechanism(file, ("motor",), ("knee",), loop, "toe", (("knee", 1.0),), ((0.6, 2.3),), held)
    own = import_model(mechanism, Drives((1.0,), (0.01,), (0.0,), (20.0,)), tmp_path / "knee.toml")
    checks = posture_checks(Subject.of(own, 8, 0, 1e-9), 0)
    assert own.posture_dependent and {check.name for check in checks} >= {
        "posture_coriolis",
        "posture_motion",
    }
    assert not failures(checks)


@pytest.mark.parametrize("name", ["four_bar", "ankle"])
def test_other_mechanisms_agree(name: str) -> None:
    checks = posture_checks(Subject.of(read_model(name), 8, 0, 1e-9), 0)
    assert len(checks) == 8 and not failures(checks)


def test_a_wrong_length_in_the_tree(tmp_path: Path) -> None:
    old = '<body name="distal_1" pos="0 0 -0.16">'
    result = broken(tmp_path, ("xml", old, old.replace("0.16", "0.17")))
    assert "forward_kinematics" in failures(result.checks)


def test_a_wrong_length_in_the_linkage(tmp_path: Path) -> None:
    old = '<frame name="meet_2" attached_to="distal_2"><pose>0 0 -0.26'
    result = broken(tmp_path, ("sdf", old, old.replace("0.26", "0.25")))
    assert failures(result.checks) == {"transmission"}
    assert "drive 'rear' moves" in next(c.hint for c in result.checks if not c.passed)


def test_a_wrong_sign_in_the_transmission(tmp_path: Path) -> None:
    result = broken(tmp_path, ("toml", "[1.385865, 1.594932]", "[1.385865, -1.594932]"))
    assert failures(result.checks) == {"transmission"}


def test_drives_in_the_wrong_order(tmp_path: Path) -> None:
    result = broken(tmp_path, ("toml", '["drive_1", "drive_2"]', '["drive_2", "drive_1"]'))
    assert "transmission" in failures(result.checks)


def test_limits_the_mechanism_cannot_reach_are_left_out(tmp_path: Path) -> None:
    result = broken(tmp_path, ("toml", "[-2.0, -1.2]", "[-2.6, -1.2]"))
    assert result.passed
    assert any(line.startswith("knee_1 from -2.6 to ") for line in result.not_checked)
    subject = Subject.of(read_model(tmp_path / "five_bar.toml"), 40, 0, 1e-9)
    assert subject.unreached == 0 and subject.states.position[:, 1].min() > -2.6


def test_limits_about_no_posture_that_closes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="closes the loops"):
        broken(tmp_path, ("toml", "[-2.0, -1.2]", "[-2.9, -2.6]"))


def test_states_that_the_mechanism_cannot_be_in_are_counted(tmp_path: Path) -> None:
    # where the mechanism's limits are not stated, states are drawn within those of the tree
    none = ("toml", "limits = [[0.4, 1.4], [-2.0, -1.2]]", "")
    model = read_model(made(tmp_path, none, ("xml", 'range="-2 -1.2"', 'range="-2.6 -1.2"')))
    subject, result = Subject.of(model, 40, 0, 1e-9), verify(model, samples=40)
    assert 0 < subject.unreached < 30 and len(subject.states) == 40 - subject.unreached
    left = f"{subject.unreached} of 40 random states within the limits"
    assert f"{left}: the closed chain cannot reach them" in result.not_checked


def test_without_limits_the_terms_are_compared_all_the_same(tmp_path: Path) -> None:
    file = made(tmp_path, ("toml", "limits = [[0.4, 1.4], [-2.0, -1.2]]", ""))
    result = verify(read_model(file), samples=8)
    assert result.passed
    assert any("no limits" in line for line in result.not_checked)


def test_an_engine_with_another_mass_is_told(tmp_path: Path) -> None:
    failed = against_another(tmp_path, ("sdf", "<mass>0.12</mass>", "<mass>0.13</mass>"))
    assert failed == {"posture_mass_matrix", "posture_coriolis", "posture_gravity"}


def test_an_engine_with_another_length_is_told(tmp_path: Path) -> None:
    old = "0 0 -0.26 0 0 0</pose></frame>"
    failed = against_another(tmp_path, ("sdf", old, old.replace("0.26", "0.255")))
    assert {"posture_drives", "posture_jacobian", "posture_mass_matrix"} <= failed
