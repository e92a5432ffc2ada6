"""All links of an arm at once: the file gets bodies that explain the torque, and the rest is then named."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.core import Controller, InputError, Recording
from workbench.diagnosis import diagnose
from workbench.effects import inertials_into_file, link_of, load_model
from workbench.identification import LinksIdentification, identify_links, links_figure, links_sheet
from workbench.identification.rigid_body import numbers_of, pseudo_inertia
from workbench.models import Model
from workbench.report import render_sheet

#: Ten numbers of the links that are not those of the model.
TRUE = {
    "upper_mass": 3.4, "upper_centre": 0.12, "upper_inertia": 0.035, "upper_roll": 0.02, "fore_mass": 0.8,
    "fore_centre": 0.19, "fore_across": 0.03, "fore_inertia": 0.012, "fore_roll": 0.02, "turret_mass": 5.0,
}  # fmt: skip
DRY = {"yaw": 0.5, "lift": 0.9, "bend": 0.4}
OTHER = tuple([(0.8 * a, 1.3 * f, p + 1.0) for a, f, p in tones] for tones in FAST)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("links")


@pytest.fixture(scope="module")
def model(folder) -> Model:
    return load_model(bench_arm(folder, "model"))


@pytest.fixture(scope="module")
def logs(folder) -> list[Recording]:
    """Two motions to fit and one to judge, of the machine whose drives have dry friction too."""
    return rubbing(bench_arm(folder, "machine", **TRUE))


@pytest.fixture(scope="module")
def found(model, logs) -> LinksIdentification:
    return identify_links(model, logs[:2], logs[2:])


def rubbing(machine: Path) -> list[Recording]:
    size = np.array(list(DRY.values()))
    tones = (SLOW, FAST, OTHER)
    return [
        logged(machine, t, seed=k, resisting=lambda q, w: -size * np.tanh(w / 0.01))
        for k, t in enumerate(tones)
    ]


def test_links_explain_what_friction_leaves(found):
    assert found.share > 0.99
    assert found.held_out and found.springs == ()
    for torque in found.torques:
        assert torque.after < 1.1 * torque.noise < 0.2 * torque.drives <= torque.before


def test_intervals_of_all_numbers_cover_the_truth(found, folder):
    machine = load_model(bench_arm(folder, "machine", **TRUE))
    off = []
    for link in found.links:
        own = link_of(machine, link.axis)
        assert own is not None
        true = numbers_of(own.inertial)
        off += [(n.value - t) / n.std for n, t in zip(link.numbers.values(), true, strict=True)]
    assert np.mean(np.abs(off) < 2.0) > 0.9
    assert np.abs(off).max() < 4.0


def test_moments_of_the_last_link_are_found(found):
    """What turns alone is seen alone: 0.8 kg at (0.19, 0.03) m, and what that needs about the hinge."""
    numbers = found.links[-1].numbers
    assert numbers["first_moment_x"].value == pytest.approx(0.152, abs=5e-4)
    assert numbers["first_moment_z"].value == pytest.approx(0.024, abs=5e-4)
    assert numbers["inertia_yy"].value == pytest.approx(0.0416, abs=2e-4)
    assert all(
        numbers[name].identifiable > 0.99 for name in ("first_moment_x", "first_moment_z", "inertia_yy")
    )
    assert numbers["first_moment_y"].identifiable < 0.99  # along both hinges: seen by yaw alone, with others


def test_links_are_bodies_that_can_exist(found):
    for link in found.links:
        values = np.array([n.value for n in link.numbers.values()])
        assert np.linalg.eigvalsh(pseudo_inertia(values))[0] > 0.0


def test_with_the_new_file_only_the_friction_is_missing(found, model, logs, folder):
    made = inertials_into_file(model, model.serial, {link.joint: link.after for link in found.links})
    (folder / "fixed.xml").write_bytes(made.content)
    result = diagnose(load_model(folder / "fixed.xml"), logs[:2])
    assert result.verdict == "missing_effect"
    named = {(f.key.effect, f.key.axis): f.parameters["torque"].value for f in result.findings}
    assert named == {("coulomb_friction", axis): pytest.approx(size, rel=0.02) for axis, size in DRY.items()}
    assert result.after is not None
    assert result.after.error < 1.2 * result.after.noise_error < 0.1 * result.error


def test_right_links_stay(folder):
    """Where only friction is missing, the links' numbers move by no more than noise says."""
    machine = bench_arm(folder, "right")
    found = identify_links(load_model(machine), rubbing(machine)[:2])
    assert found.share < 0.5
    for link in found.links:
        assert link.after.mass == pytest.approx(link.before.mass, rel=0.02)
        np.testing.assert_allclose(link.after.centre, link.before.centre, atol=0.002)


def test_a_spring_is_no_link(folder):
    """A counterbalance is fitted beside: links that are right stay, where they would have been bent to it."""
    machine = bench_arm(folder, "sprung", bend_stiffness=6.0, bend_rest=0.5)
    found = identify_links(load_model(bench_arm(folder, "plain")), rubbing(machine)[:2])
    assert found.springs == ("bend",)
    for link in found.links:
        assert link.after.mass == pytest.approx(link.before.mass, rel=0.1)


def test_a_rotor_that_is_not_stated_is_no_link(folder):
    machine = bench_arm(folder, "with_rotors")
    bare = load_model(bench_arm(folder, "bare", yaw_armature=0.0, lift_armature=0.0, bend_armature=0.0))
    found = identify_links(bare, rubbing(machine)[:2])
    for link in found.links:
        assert link.after.mass == pytest.approx(link.before.mass, rel=0.1)


def test_without_a_torque_it_is_refused(model, logs):
    there = {name: x for name, x in logs[0].signals.items() if not name.startswith("torque")}
    unknown = [replace(logs[0], signals=there, controller=Controller(kind="unknown"))]
    with pytest.raises(InputError, match="torque along this motion is not known"):
        identify_links(model, unknown)


def test_a_parallel_leg_is_refused(logs):
    with pytest.raises(InputError, match="identify leg"):
        identify_links(load_model("leg"), logs)


def test_a_robot_on_the_ground_is_refused(model, logs):
    standing = [replace(logs[0], extra={"ground_force": np.ones((len(logs[0]), 1))})]
    with pytest.raises(InputError, match="forces of the ground are not known"):
        identify_links(model, standing)


def test_page_and_picture_say_it(found):
    page = render_sheet(links_sheet(found), command="workbench identify links")
    assert "New numbers of the links explain" in page
    assert "upper" in page and "first moment x" in page
    assert [t.get_text() for t in links_figure(found).axes[0].get_yticklabels()] == list(DRY)
