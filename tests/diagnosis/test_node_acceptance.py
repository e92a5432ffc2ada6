"""Which node of a search takes the place of the best one so far."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from workbench.core import EffectKey
from workbench.diagnosis.adequacy.free_functions import Adequacy
from workbench.diagnosis.loss import rescored
from workbench.diagnosis.node import Node
from workbench.diagnosis.node_acceptance import CERTAIN, EXPLAINED, UNEXPLAINED, standing
from workbench.diagnosis.node_acceptance import accepts as judged
from workbench.diagnosis.problem import Problem
from workbench.effects import load_model
from workbench.models import AppliedEffect
from workbench.rigs import HiddenEffect

from .rig import applied, asked, node_with, recordings

LEG = load_model("leg")
FRICTION = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.4})


def accepts(child: Node, best: Node, problem: Problem) -> bool:
    """Whether it is taken."""
    taken, why = judged(child, best, problem)
    assert why, "a reason is always told"
    return taken


@cache
def lacking() -> tuple[Problem, Node]:
    """A leg that lacks friction, and the node that has it."""
    problem = asked(LEG, *recordings(FRICTION))
    friction = applied(LEG, EffectKey("coulomb_friction", "knee"), torque=0.39)
    return problem, node_with(problem, friction)


def leaving(share: float, parameters: int = 1, **told: object) -> Node:
    """A node that leaves this share of the excess, with so many free parameters."""
    problem, node = lacking()
    floor = problem.data.floor
    squares = floor + share * np.maximum(problem.start.mean_squares - floor, 0.0)
    (one,) = node.current.hypothesis.free
    estimate = one.parameters["torque"]
    more = AppliedEffect(one.key, {f"p{k}": estimate for k in range(parameters)})
    hypothesis = replace(node.current.hypothesis, free=(more,))
    fit = replace(node.current, hypothesis=hypothesis, mean_squares=squares)
    return replace(node, current=rescored(fit, problem.data), data=problem.data, done=False, **told)  # type: ignore[arg-type]


def test_what_noise_explains_is_explained() -> None:
    problem, node = lacking()
    assert node.done and standing(node, problem) == EXPLAINED
    assert accepts(node, Node(problem.start, problem.data), problem)


@pytest.mark.parametrize(
    ("share", "bold", "jointly", "level"),
    [
        (0.04, False, False, EXPLAINED),
        (0.04, True, False, UNEXPLAINED),  # one of many bold starts may do so by chance
        (0.015, True, False, EXPLAINED),
        (0.3, False, False, UNEXPLAINED),
        (0.3, False, True, CERTAIN),
    ],
)
def test_bold_starts_have_to_explain_more(share: float, bold: bool, jointly: bool, level: int) -> None:
    assert standing(leaving(share, bold=bold, jointly=jointly), lacking()[0]) == level


def test_certain_effects_say_more_than_what_is_not_named() -> None:
    """As an effect whose size may be none may not."""
    problem, node = lacking()[0], leaving(0.03)
    (one,) = node.current.hypothesis.free

    def with_deviation(share: float) -> Node:
        torque = replace(one.parameters["p0"], std=share * abs(one.parameters["p0"].value))
        hypothesis = replace(node.current.hypothesis, free=(AppliedEffect(one.key, {"torque": torque}),))
        return replace(node, current=replace(node.current, hypothesis=hypothesis))

    whole, unnamed = with_deviation(0.01), with_deviation(1.0)
    certain = leaving(0.3, jointly=True, adequacy={one.key: Adequacy(1.0, 1.0, 0.0)})
    assert accepts(certain, unnamed, problem) and not accepts(unnamed, certain, problem)
    assert accepts(whole, certain, problem) and not accepts(certain, whole, problem)


@pytest.mark.parametrize(
    ("child", "best", "taken"),
    [
        (leaving, (0.04, 1), True),  # explained goes before unexplained
        ((0.018, 3), (0.04, 1), True),  # at most half of the excess, whatever it takes
        ((0.03, 3), (0.04, 1), False),
        ((0.03, 1), (0.04, 3), False),  # fewer parameters count where no more than noise is left
    ],
)
def test_less_error_or_fewer_parameters(child: object, best: tuple[float, int], taken: bool) -> None:
    problem = lacking()[0]
    new = leaving(0.03) if child is leaving else leaving(*child)  # type: ignore[misc]
    old = leaving(0.5) if child is leaving else leaving(*best)
    assert accepts(new, old, problem) is taken


def test_what_does_as_well_is_taken_unless_it_has_more_numbers() -> None:
    problem = lacking()[0]
    assert accepts(leaving(0.041, 2, as_good=True), leaving(0.04, 2), problem)
    assert not accepts(leaving(0.041, 3, as_good=True), leaving(0.04, 2), problem)
    assert not accepts(leaving(0.041, 2), leaving(0.04, 2), problem)


def test_of_two_at_the_noise_the_one_with_fewer_parameters() -> None:
    problem, node = lacking()
    wide = replace(leaving(0.0, 4), done=True)
    assert accepts(node, wide, problem) and not accepts(wide, node, problem)
    together = replace(node, jointly=True)
    assert accepts(node, together, problem), "fitted in the loop, of two with as many"
    assert not accepts(together, node, problem)


def test_first_effects_are_taken_and_a_bold_guess_is_not() -> None:
    problem = lacking()[0]
    root = Node(problem.start, problem.data)
    assert accepts(leaving(0.6), root, problem)
    assert not accepts(leaving(0.6, bold=True), root, problem)


def test_what_adds_to_one_whose_runs_diverge_is_no_better() -> None:
    problem, gap = lacking()[0], EffectKey("backlash", "hip")
    spring = applied(LEG, EffectKey("parallel_spring", "knee"), stiffness=5.0, rest=0.0)

    def with_effects(node: Node, *more: AppliedEffect) -> Node:
        hypothesis = node.current.hypothesis
        wide = replace(hypothesis, free=(*hypothesis.free, *more))
        return replace(node, current=replace(node.current, hypothesis=wide))

    loose = applied(LEG, gap, gap=0.02, stiffness=2000.0)
    best, more = with_effects(leaving(0.04), loose), with_effects(leaving(0.01), loose, spring)
    assert best.diverges and not accepts(more, best, problem)
    assert accepts(with_effects(leaving(0.01), spring), best, problem), "another cause may be better"


@pytest.mark.parametrize(("held_out", "taken"), [(0.95, False), (0.6, True)])
def test_what_is_added_lowers_the_held_out_error_too(held_out: float, taken: bool) -> None:
    """Where held-out data are at the noise already, they have no excess that could fall."""
    problem = lacking()[0]

    def tested(node: Node, times_floor: float) -> Node:
        squares = node.current.mean_squares.copy()
        squares[-1] = times_floor * problem.data.least(held_out=True)
        return replace(node, current=rescored(replace(node.current, mean_squares=squares), problem.data))

    best, child = tested(leaving(0.03), 0.99), tested(leaving(0.012), held_out)
    (one,) = child.current.hypothesis.free
    more = AppliedEffect(EffectKey("torque_constant_error", "hip"), one.parameters)
    added = replace(child.current.hypothesis, free=(one, more))
    assert accepts(replace(child, current=replace(child.current, hypothesis=added)), best, problem) is taken
