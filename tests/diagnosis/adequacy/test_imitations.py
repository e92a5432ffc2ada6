"""A law that is in no catalogue is followed by laws that are, with numbers that no machine has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from tests.diagnosis.rig import asked
from workbench.core import EffectKey
from workbench.diagnosis.adequacy.imitations import imitate_another_law, imitations
from workbench.diagnosis.moves.joint_fit import certain_of, fit_of_selection
from workbench.diagnosis.node import Node
from workbench.diagnosis.node_acceptance import are_the_laws
from workbench.diagnosis.screening.selection import selection_of
from workbench.effects import load_model

DAMPING, DRAG = EffectKey("viscous_damping", "lift"), EffectKey("quadratic_drag", "lift")


def cubic(position: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Friction that grows with the cube of speed, which the catalogue does not have."""
    return np.array([0.0, -1.5 * speed[1] ** 3, 0.0])


def quadratic(position: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Quadratic drag, and half of the damping that the model states."""
    return np.array([0.0, -1.5 * speed[1] * abs(speed[1]) + 0.4 * speed[1], 0.0])


@pytest.mark.parametrize(("resisting", "told"), [(cubic, {DAMPING, DRAG}), (quadratic, set())])
def test_less_than_nothing_of_one_law_is_the_curve_of_another(tmp_path: Path, resisting, told) -> None:
    machine = bench_arm(tmp_path)
    logs = [logged(machine, t, seconds=5.0, resisting=resisting, seed=k) for k, t in enumerate((SLOW, FAST))]
    problem = asked(load_model(machine), logs)
    assert problem.inverse_dynamics is not None
    data, start, regression = problem.inverse_dynamics
    chosen = selection_of(tuple(e for e in regression.entries if e.key in {DAMPING, DRAG}), regression)
    found = fit_of_selection(regression, chosen, start, data)
    assert found is not None and found.hypothesis.keys == {DAMPING, DRAG}
    assert imitations(regression, chosen.chosen, found.hypothesis.keys) == told
    assert imitate_another_law(found.hypothesis.free, regression) == bool(told)
    certain = certain_of(regression, start, data)
    assert certain is not None and (not told or not certain.known.keys() & told)


@pytest.mark.parametrize("resisting", [cubic, quadratic])
def test_what_is_close_to_a_law_is_not_that_law(tmp_path: Path, resisting) -> None:
    """Quadratic drag explains most of a cubic friction, and a free curve over speed explains plainly more."""
    machine = bench_arm(tmp_path)
    logs = [logged(machine, t, seconds=5.0, resisting=resisting, seed=k) for k, t in enumerate((SLOW, FAST))]
    problem = asked(load_model(machine), logs)
    assert problem.inverse_dynamics is not None
    data, start, regression = problem.inverse_dynamics
    keys = {DRAG} if resisting is cubic else {DAMPING, DRAG}
    chosen = selection_of(tuple(e for e in regression.entries if e.key in keys), regression)
    found = fit_of_selection(regression, chosen, start, data)
    assert found is not None and found.hypothesis.keys == keys
    assert are_the_laws(Node(found, problem.data), problem) == (resisting is quadratic)


def test_one_more_harmonic_is_solved_without_its_bounds(tmp_path: Path) -> None:
    """An effect that repeats is in no list of those that a place may have once."""
    machine = bench_arm(tmp_path)
    problem = asked(load_model(machine), [logged(machine, SLOW, seconds=5.0)])
    assert problem.inverse_dynamics is not None
    regression = problem.inverse_dynamics[2]
    first = next(e for e in regression.entries if str(e.key) == "cogging@lift")
    second = regression.copies([first])[0]
    free = regression.without_bounds(second).solved((first, second)).coefficients
    np.testing.assert_allclose(free, regression.solved((first, second)).coefficients)


@pytest.mark.parametrize(("metres", "told"), [(0.2, True), (0.05, False)])
def test_a_length_that_no_link_can_be_off_is_another_cause(tmp_path: Path, metres: float, told: bool) -> None:
    """The data want 0.2 m where 0.1 m is the most: the value at that bound stands for something else."""
    length, machine = EffectKey("link_length_error", "lift"), bench_arm(tmp_path, "machine")
    machine.write_text(machine.read_text().replace('pos="0.35 0 0"', f'pos="{0.35 + metres} 0 0"'))
    logs = [logged(machine, t, seconds=5.0, seed=k) for k, t in enumerate((SLOW, FAST))]
    problem = asked(load_model(bench_arm(tmp_path)), logs)
    assert problem.inverse_dynamics is not None
    regression = problem.inverse_dynamics[2]
    chosen = tuple(e for e in regression.entries if e.key == length)
    assert imitations(regression, chosen, {length}) == ({length} if told else set())


def test_damping_of_none_is_no_other_cause(tmp_path: Path) -> None:
    """The model states some, the machine has none: at its bound, and right."""
    machine = bench_arm(tmp_path, "machine", lift_damping=0.0)
    logs = [logged(machine, t, seconds=5.0, seed=k) for k, t in enumerate((SLOW, FAST))]
    problem = asked(load_model(bench_arm(tmp_path)), logs)
    assert problem.inverse_dynamics is not None
    regression = problem.inverse_dynamics[2]
    chosen = tuple(e for e in regression.entries if e.key == DAMPING)
    assert imitations(regression, chosen, {DAMPING}) == set()
