"""Which moves are worth their work, and what bold starts begin with."""

from __future__ import annotations

from workbench.core import EffectKey
from workbench.diagnosis.moves import restarts
from workbench.diagnosis.moves.order import MOVES, ONE_BY_ONE
from workbench.diagnosis.node import Node
from workbench.diagnosis.problem import Problem
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

from ..rig import applied, asked, node_with, recordings

LEG = load_model("leg")
DAMPING, FRICTION = (EffectKey(effect, "knee") for effect in ("viscous_damping", "coulomb_friction"))
_SIMPLER = {"without effects that are no longer needed", "a special case in place of a refinement"}


def wanted(node: Node, problem: Problem) -> set[str]:
    """Names of the moves that are worth their work for the best node."""
    return {m.name for m in MOVES if m.wanted(node, node, problem)}


def test_at_the_noise_only_simpler_models_are_asked_for() -> None:
    problem = asked(LEG, *recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3})))
    node = node_with(problem, applied(LEG, DAMPING, damping=0.28), move=ONE_BY_ONE)
    assert node.done
    assert wanted(node, problem) == {*_SIMPLER, "one cause in place of two"}
    wrong = node_with(problem, applied(LEG, FRICTION, torque=0.1), move=ONE_BY_ONE)
    starts = wanted(wrong, problem)
    assert {
        "one cause on every axis",
        "two causes at once",
        "a gap or soft joint that explains the residual torque",
    } <= starts
    assert "one cause in place of two" not in starts, "what explains less is not named"


def test_a_root_asks_for_effects_one_by_one() -> None:
    problem = asked(LEG, *recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3})))
    assert wanted(Node(problem.start, problem.data), problem) >= {ONE_BY_ONE}


def test_a_gap_that_the_torque_shows_is_a_bold_start() -> None:
    gap = HiddenEffect("backlash", "knee", parameters={"gap": 0.0084, "stiffness": 375.0})
    problem = asked(LEG, *recordings(gap))
    node = node_with(problem, applied(LEG, FRICTION, torque=0.05), move=ONE_BY_ONE)
    first = next(restarts.clear_compliance(node, problem))
    assert first.bold and [s.added for s in first.steps] == [EffectKey("backlash", "knee")]
