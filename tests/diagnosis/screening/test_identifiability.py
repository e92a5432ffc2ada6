"""What recordings can tell apart and how well: against intervals of fits, and in limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, NUMBERS, SLOW, bench_arm, logged
from workbench.core import Diagnosis, EffectKey, Recording
from workbench.diagnosis import diagnose, fit_effect
from workbench.diagnosis.data import gather
from workbench.diagnosis.problem import Problem, starting_fit
from workbench.diagnosis.screening.disagreement import disagreements
from workbench.diagnosis.screening.linear_problem import linear_along
from workbench.effects import load_model
from workbench.models import Model


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> tuple[Model, list[Recording]]:
    file = bench_arm(tmp_path_factory.mktemp("arm"))
    logs = [logged(file, tones, seconds=6.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    return load_model(file), logs


@pytest.fixture(scope="module")
def told(arm: tuple[Model, list[Recording]]) -> Diagnosis:
    return diagnose(*arm)


@pytest.mark.parametrize(
    ("effect", "number", "more"),
    [("viscous_damping@lift", "lift_damping", 0.25), ("reflected_inertia@bend", "bend_armature", 0.016)],
)
def test_expected_deviations_are_those_of_fits(
    effect: str, number: str, more: float, arm: tuple[Model, list[Recording]], told: Diagnosis, tmp_path: Path
) -> None:
    """Of an effect as small as those that are asked for."""
    model, _ = arm
    machine = bench_arm(tmp_path, "machine", **{number: NUMBERS[number] + more})
    logs = [logged(machine, tones, seconds=6.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    name, axis = effect.split("@")
    key = EffectKey(name, axis)
    fitted, _ = fit_effect(model, logs, key)
    assert told.identifiability is not None
    ((parameter, expected),) = dict(told.identifiability.expected)[key].items()
    assert expected.value == pytest.approx(more, rel=0.1)
    assert 0.5 < expected.std / fitted.parameters[parameter].std < 2.0


def test_what_nothing_tells_apart_is_one_group(told: Diagnosis) -> None:
    known = told.identifiability
    assert known is not None
    # no other axis turns the first link, and yaw never speeds up so much that the inertia of the upper arm
    # were another than the rotor's beside it
    groups = [
        (EffectKey("reflected_inertia", a), EffectKey("link_inertia_error", a)) for a in ("yaw", "lift")
    ]
    assert set(known.groups) == set(groups)
    everything = [*known.separable, *known.not_excited, *groups[0], *groups[1]]
    assert len(everything) == len(set(everything))
    # no weight turns a vertical axis
    assert EffectKey("first_moment_error", "yaw") in known.not_excited
    assert known.not_excited == told.not_excited


@pytest.mark.parametrize(("axis", "twins"), [("lift", True), ("bend", False)])
def test_a_finding_names_what_stands_for_it(axis: str, twins: bool, tmp_path: Path) -> None:
    """The upper arm turns about one horizontal axis like its rotor; the fore-arm's inertia loads lift too."""
    number = f"{axis}_armature"
    machine = bench_arm(tmp_path, "machine", **{number: NUMBERS[number] + 0.03})  # type: ignore[arg-type]
    logs = [logged(machine, tones, seconds=6.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    (finding,) = diagnose(load_model(bench_arm(tmp_path)), logs).findings
    assert str(finding.key) == f"reflected_inertia@{axis}"
    assert (EffectKey("link_inertia_error", axis) in finding.indistinguishable_from) is twins


def test_longer_recordings_are_expected_to_tell_more(arm: tuple[Model, list[Recording]]) -> None:
    model, _ = arm
    lengths = [logged(Path(model.serial), SLOW, seconds=t) for t in (1.5, 6.0)]
    key = EffectKey("viscous_damping", "lift")
    short, long = (
        dict(d.identifiability.expected)[key]["damping"].std
        for d in (diagnose(model, [r]) for r in lengths)
        if d.identifiability is not None
    )
    assert long < short


def test_recordings_of_two_machines_disagree_by_the_difference(tmp_path: Path) -> None:
    machines = [bench_arm(tmp_path, f"arm_{d}", lift_damping=d) for d in (1.4, 2.4)]
    logs = [logged(m, FAST, seconds=6.0, seed=k) for k, m in enumerate(machines)]
    model = load_model(bench_arm(tmp_path))
    data, runs = gather(model, logs, (), seed=0)
    linear = Problem(starting_fit(model, data, runs.clean), data, 1, 0, print).linear
    assert linear is not None
    (found,) = disagreements(linear, ("one day", "another"))
    assert (str(found.key), found.recordings) == ("viscous_damping@lift", ("one day", "another"))
    np.testing.assert_allclose(found.values, (0.6, 1.6), rtol=0.1)


def test_one_recording_of_another_machine_disagrees_when_near(tmp_path: Path) -> None:
    """Right recordings are a little off too, by far less than the other one."""
    bend = {"bend_damping": 1.2 * NUMBERS["bend_damping"]}
    machines = [bench_arm(tmp_path, f"arm_{d}", lift_damping=d, **bend) for d in (0.8, 0.8, 2.4)]
    logs = [logged(m, FAST, seconds=6.0, seed=k) for k, m in enumerate(machines)]
    model = load_model(bench_arm(tmp_path))
    data, runs = gather(model, logs, (), seed=0)
    along = Problem(starting_fit(model, data, runs.clean), data, 1, 0, print).inverse_dynamics
    assert along is not None
    linear = linear_along(along[2])
    assert (linear.excess > linear.quiet).all()
    (found,) = disagreements(linear, ("one", "two", "three"))
    assert str(found.key) == "viscous_damping@lift"
    np.testing.assert_allclose(found.values, (0.0, 0.0, 1.6), atol=0.15)


def test_recordings_of_one_machine_do_not_disagree(tmp_path: Path, told: Diagnosis) -> None:
    machine = bench_arm(tmp_path, "damped", lift_damping=1.6)
    logs = [logged(machine, tones, seconds=6.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    assert diagnose(load_model(bench_arm(tmp_path)), logs).disagreeing == told.disagreeing == ()
