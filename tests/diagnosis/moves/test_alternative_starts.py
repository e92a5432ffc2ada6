"""When which other beginning is asked for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from tests.diagnosis.rig import applied, searched_from
from workbench.core import EffectKey
from workbench.diagnosis import search
from workbench.diagnosis.moves import alternative_starts
from workbench.diagnosis.node import Node
from workbench.diagnosis.problem import Problem
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

LEG = load_model("leg")
DAMPING, FRICTION = (EffectKey(effect, "knee") for effect in ("viscous_damping", "coulomb_friction"))
DAMPED = HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3})


def node(**values: Any) -> Node:
    """A place on a way of one stage."""
    return cast(Node, SimpleNamespace(steps=("first",), current=None, data=None, **values))


def test_what_the_torque_shows_plainly_goes_before_all_else(monkeypatch: pytest.MonkeyPatch) -> None:
    found = node()
    monkeypatch.setattr(alternative_starts, "_accepted_compliance", lambda *_: found)
    problem = cast(Problem, SimpleNamespace(start=None, data=None))
    assert alternative_starts.alternative_starts(node(), problem) is found


def test_the_torque_is_asked_too_where_most_is_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Node] = []

    def shown(at: Node, problem: Problem) -> Node:
        asked.append(at)
        return at

    monkeypatch.setattr(search, "with_compliance_from_torque", shown)
    searched_from(monkeypatch, LEG, [DAMPED], applied(LEG, DAMPING, damping=0.28))
    assert [s.added for at in asked for s in at.steps] == [DAMPING]


@pytest.mark.parametrize("near", [True, False])
def test_where_hardly_more_than_noise_is_left_no_more_is_asked(
    monkeypatch: pytest.MonkeyPatch, near: bool
) -> None:
    here, further = node(), node()
    monkeypatch.setattr(alternative_starts, "near_noise_floor", lambda *_: near)
    monkeypatch.setattr(alternative_starts, "forward_selection", lambda *_, **__: further)
    monkeypatch.setattr(alternative_starts, "with_last_step", lambda at, *_: at)
    led = alternative_starts._allowing_divergence(here, cast(Problem, SimpleNamespace(seed=0)))
    assert led is (here if near else further)


@pytest.mark.parametrize(
    ("done", "near", "sure", "better", "taken"),
    [
        (False, False, True, True, True),
        (True, False, True, True, False),
        (False, True, True, True, False),
        (False, False, False, True, False),
        (False, False, True, False, False),
    ],
)
def test_what_a_basic_effect_went_before_is_begun_with_where_more_than_noise_is_left_and_it_mends_that(
    monkeypatch: pytest.MonkeyPatch, done: bool, near: bool, sure: bool, better: bool, taken: bool
) -> None:
    here, other = node(done=done), node(done=True)
    monkeypatch.setattr(alternative_starts, "_refined", lambda *_: iter((other,)))
    monkeypatch.setattr(alternative_starts, "effect_keys", lambda *_: frozenset())
    monkeypatch.setattr(alternative_starts, "near_noise_floor", lambda *_: near)
    monkeypatch.setattr(alternative_starts, "_explains_nearly_all", lambda *_: sure)
    monkeypatch.setattr(alternative_starts, "halves_excess", lambda *_: better)
    led = alternative_starts.retry_with_refinement(here, cast(Problem, SimpleNamespace()))
    assert led is (other if taken else here)


@pytest.mark.parametrize("came_later", [False, True])
def test_what_came_later_all_the_same_is_not_begun_with(
    monkeypatch: pytest.MonkeyPatch, came_later: bool
) -> None:
    better, other = EffectKey("asymmetric_friction", "knee"), node(done=True)
    first = SimpleNamespace(added=FRICTION, ranking=((better, 0.99), (FRICTION, 0.8)), fit=None)
    held = frozenset({FRICTION, better} if came_later else {FRICTION})
    monkeypatch.setattr(
        alternative_starts, "effect_keys", lambda found: held if found == "end" else frozenset()
    )
    monkeypatch.setattr(alternative_starts, "near_noise_floor", lambda *_: False)
    monkeypatch.setattr(alternative_starts, "_allowing_divergence", lambda *_, **__: other)
    monkeypatch.setattr(alternative_starts, "_explains_nearly_all", lambda *_: True)
    monkeypatch.setattr(alternative_starts, "halves_excess", lambda *_: True)
    here = cast(Node, SimpleNamespace(steps=(first,), current="end", data=None, done=False))
    problem = SimpleNamespace(start=None, data=SimpleNamespace(budget=SimpleNamespace(spent=False)))
    problem.progress = lambda text: None
    led = alternative_starts.retry_with_refinement(here, cast(Problem, problem))
    assert led is (here if came_later else other)


def test_what_was_passed_over_is_asked_where_most_is_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    other = searched_from(monkeypatch, LEG, [DAMPED], applied(LEG, DAMPING, damping=0.28))
    assert other.consistent_after

    def better_refinement(at: Node, problem: Problem) -> Node:
        assert [s.added for s in at.steps] == [FRICTION]
        return Node(other.final, other.steps[-1].data, other.steps, done=True)

    monkeypatch.setattr(search, "retry_with_refinement", better_refinement)
    monkeypatch.setattr(search, "explains_data", lambda *_: True)
    found = searched_from(monkeypatch, LEG, [DAMPED], applied(LEG, FRICTION, torque=0.1))
    assert [a.key for a in found.final.hypothesis.free] == [DAMPING]
