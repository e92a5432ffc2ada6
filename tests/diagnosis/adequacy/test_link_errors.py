"""An arm whose masses are guesses: errors of all links together are set apart, and friction is what it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import AXES, FAST, SLOW, bench_arm, logged
from tests.diagnosis.rig import asked
from workbench.core import EffectKey
from workbench.diagnosis import diagnose
from workbench.diagnosis.adequacy.link_errors import (
    LinkErrors,
    link_errors,
    may_imitate_friction,
    without_link_errors,
)
from workbench.diagnosis.moves.apart import certain_apart
from workbench.diagnosis.moves.joint_fit import certain_of, freed_of
from workbench.diagnosis.moves.joint_solution import solve_jointly
from workbench.diagnosis.problem import Problem
from workbench.diagnosis.screening.torque_columns import regression_of
from workbench.diagnosis.screening.torque_regression import Regression
from workbench.effects import load_model

TRUE = {
    "upper_mass": 3.4, "upper_centre": 0.12, "upper_inertia": 0.035, "upper_roll": 0.02,
    "fore_mass": 0.8, "fore_centre": 0.19, "fore_across": 0.03, "fore_inertia": 0.012,
}  # fmt: skip
FRICTION = np.array([0.6, 0.9, 0.4])
Resisting = Callable[[np.ndarray, np.ndarray], np.ndarray]


def resisting(position: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Dry friction on all axes."""
    return -FRICTION * np.tanh(speed / 0.002)


def along(folder: Path, resisting: Resisting | None = None, **numbers: float) -> Problem:
    """A machine with other numbers than its model, and a torque that the model lacks."""
    machine = bench_arm(folder, "machine", **numbers)
    logs = [logged(machine, t, seconds=8.0, resisting=resisting, seed=k) for k, t in enumerate((SLOW, FAST))]
    return asked(load_model(bench_arm(folder, "model")), logs)


def found(folder: Path, **numbers: float) -> tuple[Problem, Regression, LinkErrors | None]:
    """Errors of all links where a machine has friction that its model lacks, and other numbers."""
    problem = along(folder, resisting, **numbers)
    assert problem.inverse_dynamics is not None
    regression = problem.inverse_dynamics[2]
    return problem, regression, link_errors(regression, (), problem.inverse_dynamics[0])


def friction_in(regression: Regression) -> tuple[np.ndarray, np.ndarray]:
    """Sizes of Coulomb friction on all axes, beside rotors, which do a part of what links do, and
    what is left of the torque on each, over the noise.
    """
    keys = [EffectKey(e, axis) for e in ("coulomb_friction", "reflected_inertia") for axis in AXES]
    chosen = tuple(e for key in keys for e in regression.entries if e.key == key)
    return regression.solved(chosen).coefficients[:3], regression.left(chosen) / regression.floor


def test_friction_is_what_it_is_without_them(tmp_path: Path) -> None:
    problem, regression, errors = found(tmp_path, **TRUE)
    assert problem.inverse_dynamics is not None and errors is not None and 0.98 < errors.share <= 1.0
    data, start, _ = problem.inverse_dynamics
    sizes, before = friction_in(regression)
    assert abs(sizes[1] - FRICTION[1]) > 0.15 and before[1] > 100.0
    freed = without_link_errors(errors, regression, data)
    assert freed is not None
    there, begun = freed_of(start, freed, data, seed=0)
    sizes, left = friction_in(regression_of(begun, there))
    assert sizes == pytest.approx(FRICTION, rel=0.01)
    assert (left < 1.0).all()


def test_the_answer_says_how_much_of_the_rest_they_explain(tmp_path: Path) -> None:
    """Friction is named beside wrong numbers of links, and the rest is said to be theirs."""
    machine = bench_arm(tmp_path, "machine", **TRUE, fore_roll=0.02)
    logs = [logged(machine, t, seconds=8.0, resisting=resisting, seed=k) for k, t in enumerate((SLOW, FAST))]
    told = diagnose(load_model(bench_arm(tmp_path, "model")), logs)
    named = {f.key.axis: f.parameters["torque"] for f in told.findings if f.key.effect == "coulomb_friction"}
    for axis, true in zip(AXES, FRICTION, strict=True):
        assert named[axis].value == pytest.approx(true, rel=0.05)
    assert any("of all links together explain" in line for line in told.evidence)


def test_friction_is_certain_once_they_are_set_apart(tmp_path: Path) -> None:
    problem, regression, _ = found(tmp_path, **TRUE)
    assert problem.inverse_dynamics is not None
    data, start, _ = problem.inverse_dynamics
    chosen = certain_of(regression, start, data, whatever_is_left=True)
    assert chosen is not None
    certain = certain_apart(replace(chosen, known={}), start, data, seed=0)
    assert certain.apart and {EffectKey("coulomb_friction", axis) for axis in AXES} <= set(certain.known)
    assert not any(may_imitate_friction(key) for key in certain.known)


@pytest.mark.parametrize("friction", [None, resisting])
def test_several_wrong_numbers_are_no_other_effect(tmp_path: Path, friction: Resisting | None) -> None:
    """A few effects come close to them, a link's length among these; friction beside them is what it is."""
    problem = along(tmp_path, friction, **TRUE, fore_roll=0.02, turret_mass=5.0)
    assert problem.inverse_dynamics is not None
    data, start, regression = problem.inverse_dynamics
    chosen = certain_of(regression, start, data)
    assert chosen is not None and chosen.by_links > 0.99
    assert "link_length_error" in {key.effect for key in chosen.whole.hypothesis.keys}
    named = {EffectKey("coulomb_friction", axis) for axis in AXES} if friction else set()
    assert set(chosen.known) == named
    node = solve_jointly(problem)
    assert node is not None and node.by_links > 0.99 and {s.added for s in node.steps} == named


@pytest.mark.parametrize("number", [{"bend_armature": 0.03}, {"fore_mass": 1.9}])
def test_one_wrong_number_is_not_several(tmp_path: Path, number: dict[str, float]) -> None:
    problem = along(tmp_path, resisting, **number)
    assert problem.inverse_dynamics is not None
    data, start, regression = problem.inverse_dynamics
    chosen = certain_of(regression, start, data, whatever_is_left=True)
    assert chosen is not None and chosen.by_links == 0.0
    assert len(chosen.known) == 4


def test_where_masses_are_right_there_are_none(tmp_path: Path) -> None:
    assert found(tmp_path)[2] is None


@pytest.mark.parametrize(
    ("effect", "imitated"),
    [
        ("coulomb_friction", False),
        ("viscous_damping", False),
        ("reflected_inertia", True),
        ("cogging", True),
        ("torque_bias", True),
    ],
)
def test_only_friction_knows_a_direction(effect: str, imitated: bool) -> None:
    assert may_imitate_friction(EffectKey(effect, "lift")) == imitated
