"""Where a search ends, whatever it simulates on the way."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

import workbench.diagnosis.search as search
from workbench.core import EffectKey, Estimate
from workbench.diagnosis import node as node_module
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Fit, Hypothesis
from workbench.diagnosis.moves import simplify
from workbench.diagnosis.node import Node, forward_selection
from workbench.diagnosis.work_budget import WorkBudget
from workbench.effects import load_model
from workbench.models import AppliedEffect
from workbench.rigs import HiddenEffect

from .rig import applied, asked, recordings, searched_from


def step(effect: str, before: tuple[AppliedEffect, ...], **parameters: tuple[float, float]) -> Any:
    """One more effect, with its estimates."""
    key = EffectKey(effect, "knee")
    own = AppliedEffect(key, {k: Estimate(value, std, "") for k, (value, std) in parameters.items()})
    hypothesis = SimpleNamespace(added=(*before, own), free=(*before, own), parameter_free=())
    return SimpleNamespace(added=key, fit=SimpleNamespace(hypothesis=hypothesis), data=f"with {effect}")


def test_last_effects_that_may_be_none_are_taken_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(node_module, "rescored", lambda fit, data: fit)
    friction = step("coulomb_friction", (), torque=(0.2, 0.01))
    ripple = step(
        "cogging", friction.fit.hypothesis.added, torque=(2e-4, 2e-4), order=(7.0, 0.1), phase=(3.0, 0.1)
    )
    lag = step("current_loop_lag", (), time_constant=(5e-6, 2e-5))
    start, first, end = SimpleNamespace(), SimpleNamespace(), SimpleNamespace()
    problem = SimpleNamespace(start=start, data=first)

    def plain(*steps: Any) -> Node:
        return search._without_insignificant_end(Node(end, end, steps, done=True), problem)  # type: ignore[arg-type]

    kept = plain(friction, ripple)
    assert kept.steps == (friction,) and kept.current is friction.fit and kept.data == "with coulomb_friction"
    assert not kept.done
    assert plain(lag) == Node(start, first)  # type: ignore[arg-type]
    assert plain(friction).current is end, "what stands out stays as it was"


def test_a_search_ends_where_it_has_been(monkeypatch: pytest.MonkeyPatch) -> None:
    def begun(text: str) -> None:
        raise AssertionError(f"went on: {text}")

    friction = step("coulomb_friction", (), torque=(0.2, 0.01))
    node = Node(friction.fit, SimpleNamespace(budget=WorkBudget()))  # type: ignore[arg-type]
    problem: Any = SimpleNamespace(start=None, progress=begun, limit=6)
    assert forward_selection(node, problem, visited=[frozenset({friction.added})]) == node
    with pytest.raises(AssertionError, match="went on"):
        forward_selection(node, problem, visited=[frozenset()])


def test_what_may_be_none_once_all_causes_are_there_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    hidden = HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3})
    leg = load_model("leg")
    viscous = applied(leg, EffectKey("viscous_damping", "knee"), damping=0.29)
    ripple = applied(leg, EffectKey("cogging", "knee"), torque=0.001, order=7.0, phase=1.0)
    found = searched_from(monkeypatch, leg, [hidden], ripple, viscous)
    (kept,) = found.final.hypothesis.free
    assert kept.key == viscous.key and kept.values["damping"] == pytest.approx(0.3, rel=0.01)
    assert found.steps[-1].dropped == (ripple.key,)
    last, data = found.steps[-1], found.steps[-1].data
    assert simplify.without(last, found.final, data) is None
    # nor is an effect left out that may be none by its size, and without which much more is left
    unsure = replace(kept, parameters={"damping": Estimate(0.3, 0.2, "N*m*s/rad")})
    doubtful = replace(found.final, hypothesis=replace(found.final.hypothesis, free=(unsure,)))
    assert simplify.without(last, doubtful, data) is None


def test_what_shrank_once_its_true_cause_came_is_left_out_however_sharp_it_is() -> None:
    leg = load_model("leg")
    friction, damping = (EffectKey(name, "knee") for name in ("coulomb_friction", "viscous_damping"))
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.2})
    problem = asked(leg, recordings(hidden)[0])
    first = applied(leg, damping, damping=0.05)
    (before,) = fit([Hypothesis(leg, (first,))], problem.data)
    (both,) = fit([Hypothesis(leg, (first, applied(leg, friction, torque=0.19)))], problem.data)
    assert before and both

    def taken(size: float) -> Any:
        was = replace(before, hypothesis=Hypothesis(leg, (applied(leg, damping, damping=size),)))
        return SimpleNamespace(added=damping, fit=was)

    def left(size: float) -> Fit:
        """Beside the friction, so much damping with no doubt of its own."""
        sharp = {"damping": Estimate(size, 1e-6, "N*m*s/rad")}
        free = tuple(replace(a, parameters=sharp) if a.key == damping else a for a in both.hypothesis.free)
        return replace(both, hypothesis=replace(both.hypothesis, free=free))

    alone = before.hypothesis.free[0].values["damping"]
    rest = simplify.without(taken(alone), left(0.1 * alone), problem.data)
    assert rest is not None
    (kept,) = rest.hypothesis.free
    assert kept.key == friction and kept.values["torque"] == pytest.approx(0.2, rel=0.01)
    assert simplify.without(taken(alone), left(0.5 * alone), problem.data) is None, (
        "what is as large as it was"
    )
    good = replace(left(0.1 * alone), test_loss=0.9 * rest.test_loss, training_loss=0.9 * rest.training_loss)
    assert simplify.without(taken(alone), good, problem.data) is None, "what is needed"
