"""What else is missing where a gap is: all of it from the torque, before any loop is closed."""

from __future__ import annotations

import numpy as np
import pytest

from tests.diagnosis.rig import applied, asked, node_with, recordings
from workbench.core import EffectKey, SimulationError
from workbench.diagnosis.acceptance import near_noise_floor
from workbench.diagnosis.explore import explore
from workbench.diagnosis.loss import test_noise_floor as noise_floor
from workbench.diagnosis.moves import beside_backlash as module
from workbench.diagnosis.moves.beside_backlash import beside_backlash
from workbench.diagnosis.moves.compliance_from_torque import compliance_from_torque
from workbench.diagnosis.moves.order import ONE_BY_ONE
from workbench.diagnosis.node import Node
from workbench.diagnosis.problem import Problem
from workbench.diagnosis.screening.compliance import compliance_candidates
from workbench.effects import load_model
from workbench.models import Model
from workbench.rigs import HiddenEffect

LEG = load_model("leg")
KEY = EffectKey("backlash", "knee")
COULOMB, INERTIA = EffectKey("coulomb_friction", "knee"), EffectKey("linkage_inertia", None)
GAP = HiddenEffect("backlash", "knee", parameters={"gap": 0.004, "stiffness": 400.0})
FRICTION = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.2})
HEAVIER = HiddenEffect("linkage_inertia", None, parameters={"M11": 0.0, "M12": 0.0, "M22": 0.0012})


@pytest.fixture(scope="module")
def heavier() -> Problem:
    """What is asked of a leg with a gap and a heavier crank."""
    return asked(LEG, *recordings(GAP, HEAVIER))


def test_a_gap_is_found_with_what_hides_its_size(heavier: Problem) -> None:
    alone = compliance_candidates(heavier.linearisation, 1.0)[0]
    assert alone.key == KEY
    gap, more = beside_backlash(heavier.linearisation, alone, heavier.start)
    assert more.key == INERTIA and more.coefficients[2] == pytest.approx(0.0012, rel=0.05)
    off, off_alone = (abs(np.log(c.shape["stiffness"] / 400.0)) for c in (gap, alone))
    assert off < 0.05 and off_alone > 0.2
    assert gap.shape["gap"] == pytest.approx(0.004, rel=0.1)


def test_each_is_a_step_and_the_error_falls_with_all(heavier: Problem) -> None:
    steps = compliance_from_torque(Node(heavier.start, heavier.data), heavier)
    assert [s.added for s in steps] == [KEY, INERTIA]
    assert [{a.key for a in s.fit.hypothesis.free} for s in steps] == [{KEY}, {KEY, INERTIA}]
    assert all(s.ranking == ((s.added, s.removed_share),) for s in steps), "and no shares of the torque"
    assert steps[-1].fit.test_loss < 0.1 * heavier.start.test_loss
    before, floor = heavier.start.test_loss, noise_floor(heavier.data)
    for s in steps:
        assert s.removed_share == pytest.approx((before - s.fit.test_loss) / (before - floor))
        before = s.fit.test_loss


def test_a_gap_that_is_all_that_is_missing_stays_alone() -> None:
    problem = asked(LEG, *recordings(GAP))
    alone = compliance_candidates(problem.linearisation, 1.0)[0]
    assert beside_backlash(problem.linearisation, alone, problem.start) == [alone]


def test_of_what_does_about_as_well_the_simplest_is_taken() -> None:
    """Dry friction has many forms, and four parameters always leave a little less than one."""
    little = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.05})
    problem = asked(LEG, *recordings(GAP, little))
    alone = compliance_candidates(problem.linearisation, 1.0)[0]
    _, friction = beside_backlash(problem.linearisation, alone, problem.start)
    assert friction.key == COULOMB and friction.coefficients == pytest.approx([0.05], rel=0.1)


def test_what_no_body_can_be_is_not_proposed(heavier: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(model: Model) -> None:
        if any(e.key == INERTIA for e in model.effects):
            raise SimulationError("no body has such an inertia")

    monkeypatch.setattr(module, "compile_plant", refuse)
    alone = compliance_candidates(heavier.linearisation, 1.0)[0]
    found = beside_backlash(heavier.linearisation, alone, heavier.start)
    assert INERTIA not in {c.key for c in found} and found[0].key == KEY


def test_an_inertia_that_stood_for_a_gap_makes_room_for_it() -> None:
    """Friction hides the gap at first, and a rotor's inertia then stands for what is left of it."""
    problem = asked(LEG, *recordings(GAP, FRICTION, HEAVIER))
    assert all(c.test_loss > 0.1 for c in compliance_candidates(problem.linearisation, 1.0))
    friction = applied(LEG, COULOMB, torque=0.2)
    stand_in = applied(LEG, EffectKey("reflected_inertia", "knee"), inertia=0.0017)
    node = node_with(problem, friction, stand_in, move=ONE_BY_ONE)
    assert not node.done
    better, trace = explore(node, problem)
    assert trace[-1].taken and set(trace[-1].effects) == better.keys
    assert near_noise_floor(better.current, better.data)
    values = {a.key: a.values for a in better.current.hypothesis.free}
    assert set(values) == {KEY, COULOMB, INERTIA}
    assert values[COULOMB]["torque"] == pytest.approx(0.2, rel=0.03)
    assert values[INERTIA]["M22"] == pytest.approx(0.0012, rel=0.1)
    assert values[KEY]["gap"] == pytest.approx(0.004, rel=0.2)
