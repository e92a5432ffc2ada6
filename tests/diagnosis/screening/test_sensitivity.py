"""By how much an unknown is moved whose slope is that of simulations."""

from __future__ import annotations

import pytest

from tests.diagnosis.rig import applied, asked, recordings
from workbench.core import EffectKey
from workbench.diagnosis.screening.sensitivity import FiniteDifference, Linearisation
from workbench.effects import load_model
from workbench.models import Model

LEG = load_model("leg")


def changes(model: Model) -> list[float]:
    """Of the weight's two coefficients, in a model with a gap."""
    problem = asked(LEG, recordings()[0])
    linearisation = Linearisation.of(
        model, problem.data, problem.start.simulated, len(problem.data.recordings)
    )
    weight = model.effects[-1]
    trials = linearisation.derivatives(weight)
    assert all(isinstance(t, FiniteDifference) for t in trials)
    return [t.change for t in trials if isinstance(t, FiniteDifference)]


def test_a_coefficient_next_to_nothing_is_moved_like_others() -> None:
    """The slope of runs that part by themselves, over a step of next to nothing, says nothing."""
    gap = applied(LEG, EffectKey("backlash", "knee"), gap=0.004, stiffness=400.0)
    small, large = (
        changes(
            LEG.with_effect(gap).with_effect(applied(LEG, EffectKey("linkage_gravity", None), g1=g1, g2=0.2))
        )
        for g1 in (0.0, 0.1)
    )
    assert small == pytest.approx([0.006, 0.006]) and large == pytest.approx([0.006, 0.006])
