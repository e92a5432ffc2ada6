"""Hypotheses side by side: those that cannot run, and those that fall behind."""

from __future__ import annotations

import pytest

from tests.diagnosis.rig import recordings
from workbench.core import EffectKey, Estimate
from workbench.diagnosis.data import Data, gather
from workbench.diagnosis.fitting import fit as fit_module
from workbench.diagnosis.fitting.fit import fit, successive_halving
from workbench.diagnosis.hypothesis import Fit, Hypothesis
from workbench.diagnosis.loss import rescored
from workbench.effects import load_model
from workbench.models import AppliedEffect
from workbench.rigs import HiddenEffect

LEG = load_model("leg")


@pytest.fixture(scope="module")
def lacking() -> tuple[Data, Fit]:
    """A leg with damping at the knee that the model has not."""
    training, _ = recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.15}))
    data, _ = gather(LEG, training, (), seed=0)
    (current,) = fit([Hypothesis(LEG, ())], data, iterations=1)
    assert current is not None
    return data, rescored(current, data)


def having(effect: str, axis: str, **values: float) -> Hypothesis:
    free = AppliedEffect(EffectKey(effect, axis), {k: Estimate(v, 0.0, "") for k, v in values.items()})
    return Hypothesis(LEG, (free,))


def test_the_right_one_wins_and_the_hopeless_fall_behind(lacking: tuple[Data, Fit]) -> None:
    data, current = lacking
    tried = [having("viscous_damping", "knee", damping=0.05), having("torque_bias", "hip", torque=0.01)]
    (right, wrong), shares = successive_halving(tried, current, data)
    assert right is not None and wrong is None
    assert right.hypothesis.free[0].parameters["damping"].value == pytest.approx(0.15, rel=0.01)
    assert shares[0] == pytest.approx(1.0, abs=0.05) and shares[1] is not None and shares[1] < 0.5


def test_a_loop_that_runs_away_takes_no_part(
    lacking: tuple[Data, Fit], monkeypatch: pytest.MonkeyPatch
) -> None:
    data, _ = lacking
    true = fit_module.propagate_sensitivities
    monkeypatch.setattr(
        fit_module, "propagate_sensitivities", lambda *told: [[1e200 * r for r in own] for own in true(*told)]
    )
    assert fit([having("viscous_damping", "knee", damping=0.05)], data) == [None]


def test_what_never_runs_takes_no_part(lacking: tuple[Data, Fit]) -> None:
    data, current = lacking
    wild = having("viscous_damping", "knee", damping=-500.0)
    assert successive_halving([wild, wild], current, data) == ([None, None], [None, None])
    assert fit([], data) == []
