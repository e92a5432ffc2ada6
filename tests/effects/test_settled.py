"""What a diagnosis settled of the model goes with the effects that need it, and with no others."""

from __future__ import annotations

import pytest

from workbench.core import EffectKey
from workbench.effects import load_model, with_settled

FRICTION, LIMIT, BIAS, PLAY = (
    EffectKey(name, "knee") for name in ("coulomb_friction", "speed_torque_limit", "torque_bias", "backlash")
)
SETTLED = {"sliding_speed": 0.007, "full_braking": 1.0, "flank_retardation_s": 0.002}


@pytest.mark.parametrize(
    ("effects", "friction", "limit"),
    [
        ([FRICTION], True, False),
        ([LIMIT], False, True),
        ([BIAS], False, False),
        ([PLAY], False, False),
        ([FRICTION, LIMIT], True, True),
    ],
)
def test_an_effect_takes_what_it_needs(effects: list[EffectKey], friction: bool, limit: bool) -> None:
    model = load_model("leg")
    new = with_settled(model, SETTLED, effects)
    assert new.sliding_speed == (0.007 if friction else model.sliding_speed)
    assert new.flank_retardation_s == (0.002 if PLAY in effects else model.flank_retardation_s)
    assert new.actuators.full_braking is (True if limit else model.actuators.full_braking)


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan"), float("inf")])
def test_a_speed_that_is_none_is_refused(speed: float) -> None:
    with pytest.raises(ValueError, match="sliding_speed"):
        with_settled(load_model("leg"), {"sliding_speed": speed}, [FRICTION])


@pytest.mark.parametrize("retardation", [-1e-3, float("nan"), float("inf")])
def test_a_retardation_that_is_none_is_refused(retardation: float) -> None:
    with pytest.raises(ValueError, match="flank_retardation_s"):
        with_settled(load_model("leg"), {"flank_retardation_s": retardation}, [PLAY])
