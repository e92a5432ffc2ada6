"""A gap beside another spring: the torque shows each of them before a closed loop shows either."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import pytest

from tests.diagnosis.rig import SPRING_AND_DELAY, applied, asked, recordings
from tests.simulation.make import having
from workbench.core import EffectKey
from workbench.diagnosis.hypothesis import Fit, Hypothesis
from workbench.diagnosis.moves.compliance_from_torque import _with_unseen, compliance_from_torque
from workbench.diagnosis.node import Node
from workbench.diagnosis.problem import Problem
from workbench.diagnosis.screening.compliance import compliance_candidates
from workbench.diagnosis.screening.sensitivity import Linearisation
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

LEG = load_model("leg")
GAP, SPRING = EffectKey("backlash", "knee"), EffectKey("joint_compliance", "hip")
BOTH = (
    HiddenEffect("backlash", "knee", parameters={"gap": 0.0084, "stiffness": 375.0}),
    HiddenEffect("joint_compliance", "hip", parameters={"stiffness": 1180.0, "damping": 1.6}),
)


PLAIN = 0.25  # of the residual torque, left: one compliance explains most of it


def root(problem: Problem) -> Node:
    """The model as it is."""
    return Node(problem.start, problem.data)


def test_a_gap_is_taken_at_the_torque_s_word_then_the_spring() -> None:
    problem = asked(LEG, *recordings(*BOTH))
    data, linearisation = problem.data, problem.linearisation
    # what stands for the spring as long as that is missing may come after the gap, by how the noise falls
    step, *_ = compliance_from_torque(root(problem), problem, most=PLAIN)
    (gap,) = step.fit.hypothesis.free
    assert gap.key == GAP and step.added == GAP
    assert gap.values["gap"] == pytest.approx(0.0084, rel=0.1)
    assert SPRING not in {c.key for c in compliance_candidates(linearisation, 1.0)}
    after = step.fit.hypothesis.model
    linearisation = Linearisation.of(after, data, step.fit.simulated, len(data.recordings))
    found = {c.key: c for c in compliance_candidates(linearisation, 1.0)}
    assert found[SPRING].test_loss < 0.05
    assert found[SPRING].shape["stiffness"] == pytest.approx(1180.0, rel=0.15)
    assert GAP not in found and EffectKey("backlash", "knee", "joint") not in found


def test_a_spring_is_taken_beside_a_delay_that_hides_it() -> None:
    """By itself it hardly lowers the error of held-out motion; both are what is missing."""
    problem = asked(LEG, *recordings(*SPRING_AND_DELAY))
    (step,) = compliance_from_torque(root(problem), problem, most=PLAIN)
    # which side of the knee it is on cannot be told before the delay is there: `instead` asks it then
    pin, drive = (EffectKey("joint_compliance", "knee", place) for place in ("joint", "actuator"))
    assert step.added in (pin, drive)
    assert {step.added, *(key for key, _ in step.loss_ratios)} == {pin, drive}
    (found,) = step.fit.hypothesis.free
    assert found.values["stiffness"] == pytest.approx(91.0, rel=0.15)


def test_nothing_is_taken_where_nothing_gives_way() -> None:
    training, _ = recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.4}))
    problem = asked(LEG, training)
    assert compliance_from_torque(root(problem), problem, most=PLAIN) == ()


def test_what_gives_way_already_asks_for_no_more() -> None:
    """A model that has the spring lacks no torque that another would explain."""
    training, _ = recordings(BOTH[1])
    soft = having(LEG, SPRING, **BOTH[1].parameters)
    problem = asked(soft, training)
    assert not compliance_candidates(problem.linearisation, 1.0)


def test_what_the_torque_does_not_show_begins_as_the_loop_had() -> None:
    weight = EffectKey("linkage_gravity", None)
    friction = applied(LEG, EffectKey("coulomb_friction", "knee"), torque=0.1)
    now = Hypothesis(LEG, (friction, applied(LEG, weight, g1=0.0, g2=0.13)))
    before = SimpleNamespace(hypothesis=Hypothesis(LEG, (applied(LEG, weight, g1=0.29, g2=0.2),)))
    first, second = _with_unseen(now, cast(Fit, before)).free
    assert first == friction
    assert second.values == {"g1": 0.29, "g2": 0.13}
