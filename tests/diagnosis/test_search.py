"""Where a search ends, whatever it simulates on the way."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from workbench.core import EffectKey, Estimate
from workbench.diagnosis.adequacy.free_functions import Adequacy
from workbench.diagnosis.explore import without_insignificant_end
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Fit, Hypothesis
from workbench.diagnosis.moves import simplify
from workbench.diagnosis.moves.add import grown
from workbench.diagnosis.node import Growth
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

from .rig import applied, asked, explored_from, node_with, recordings

LEG = load_model("leg")
FRICTION, DAMPING, RIPPLE = (
    EffectKey(name, "knee") for name in ("coulomb_friction", "viscous_damping", "cogging")
)
NOISE = {"torque": 1e-4, "order": 7.0, "phase": 1.0}


def test_last_effects_that_may_be_none_are_taken_back() -> None:
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.2})
    problem = asked(LEG, *recordings(hidden))
    friction, ripple = applied(LEG, FRICTION, torque=0.19), applied(LEG, RIPPLE, **NOISE)
    whole = node_with(problem, friction, ripple)
    kept = without_insignificant_end(whole, problem)
    assert [s.added for s in kept.steps] == [FRICTION] and kept.keys == {FRICTION}
    lone = without_insignificant_end(node_with(problem, ripple), problem)
    assert not lone.steps and not lone.keys
    alone = node_with(problem, friction)
    assert without_insignificant_end(alone, problem) is alone, "what stands out stays as it was"


def test_what_is_certain_stays_so_without_a_last_effect() -> None:
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.2})
    problem = asked(LEG, *recordings(hidden))
    whole = node_with(problem, applied(LEG, FRICTION, torque=0.19), applied(LEG, RIPPLE, **NOISE))
    sure = {key: Adequacy(0.99, 0.9, 0.02) for key in (FRICTION, RIPPLE)}
    kept = without_insignificant_end(replace(whole, jointly=True, adequacy=sure), problem)
    assert kept.keys == {FRICTION} == kept.adequacy.keys() and kept.jointly


def test_a_bold_start_grows_no_further_where_another_was() -> None:
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.2})
    told: list[str] = []
    problem = replace(asked(LEG, *recordings(hidden)), progress=told.append)
    wrong = node_with(problem, applied(LEG, DAMPING, damping=0.1), growth=Growth(), bold=True)
    first = grown(wrong, problem)
    assert FRICTION in first.keys and any("screening" in text for text in told)
    assert "simulating the noise with Coulomb friction on the knee drive" in told
    assert not [text for text in told if "@" in text or "_" in text], "in words, as verdicts are"
    told.clear()
    again = grown(wrong, problem)
    assert again.keys == wrong.keys and not told


def test_what_may_be_none_once_all_causes_are_there_is_left_out() -> None:
    hidden = HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3})
    viscous, ripple = applied(LEG, DAMPING, damping=0.29), applied(LEG, RIPPLE, **NOISE)
    found = explored_from(asked(LEG, *recordings(hidden)), ripple, viscous)
    (kept,) = found.current.hypothesis.free
    assert kept.key == viscous.key and kept.values["damping"] == pytest.approx(0.3, rel=0.01)
    assert found.steps[-1].dropped == (ripple.key,)
    last, data = found.steps[-1], found.steps[-1].data
    assert simplify.without(last, found.current, data) is None
    # nor is an effect left out that may be none by its size, and without which much more is left
    unsure = replace(kept, parameters={"damping": Estimate(0.3, 0.2, "N*m*s/rad")})
    doubtful = replace(found.current, hypothesis=replace(found.current.hypothesis, free=(unsure,)))
    assert simplify.without(last, doubtful, data) is None


def test_what_shrank_once_its_true_cause_came_is_left_out() -> None:
    leg, friction, damping = LEG, FRICTION, DAMPING
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
