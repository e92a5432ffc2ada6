"""An effect of one's own choice is fitted, whatever a search would say."""

from __future__ import annotations

import pytest

from workbench.core import EffectKey, InputError
from workbench.diagnosis import fit_effect
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

from .rig import recordings

LEG = load_model("leg")


def test_a_gap_that_was_chosen_has_its_size() -> None:
    training, _ = recordings(HiddenEffect("backlash", "hip", parameters={"gap": 0.014, "stiffness": 350.0}))
    said: list[str] = []
    gap, model = fit_effect(LEG, training, EffectKey("backlash", "hip"), progress=said.append)
    assert gap.values["gap"] == pytest.approx(0.014, rel=0.01)
    assert gap.values["stiffness"] == pytest.approx(350.0, rel=0.03)
    assert model.effects == (*LEG.effects, gap)
    assert said[-1] == "trying sizes of backlash on the hip drive"


def test_a_choice_that_is_not_the_cause_is_fitted_all_the_same() -> None:
    training, _ = recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3}))
    friction, model = fit_effect(LEG, training, EffectKey("coulomb_friction", "knee"))
    assert 0.05 < friction.values["torque"] < 2.0
    assert friction.parameters["torque"].std > 0.0
    assert model.effects == (*LEG.effects, friction)


def test_what_explains_nothing_is_refused() -> None:
    training, _ = recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3}))
    with pytest.raises(InputError, match="does not lower the error"):
        fit_effect(LEG, training, EffectKey("backlash", "hip"))
