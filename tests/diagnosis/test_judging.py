"""What no explanation may be, whatever it does for the data."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from workbench.core import EffectKey, Estimate
from workbench.diagnosis.judging import witnessed
from workbench.effects import effect_named, load_model
from workbench.models import AppliedEffect, Placement


@pytest.mark.parametrize(
    ("effect", "name", "value", "possible"),
    [
        ("torque_constant_error", "gain", 1.1, True),
        ("torque_constant_error", "gain", None, False),  # its upper bound
        ("encoder_scale", "scale", None, False),
        ("coulomb_friction", "torque", 0.0, True),
        ("viscous_damping", "damping", -0.02, True),  # all the damping that the model has
    ],
)
def test_nothing_is_named_at_the_limit_of_what_can_be(
    effect: str, name: str, value: float | None, possible: bool
) -> None:
    model, key = load_model("leg"), EffectKey(effect, "knee")
    if value is None:
        _, upper = effect_named(effect).bounds(model, Placement.of(model, key))
        value = float(upper[0]) + 1.0
    elif effect == "viscous_damping":
        lower, _ = effect_named(effect).bounds(model, Placement.of(model, key))
        value = float(lower[0])
        assert value < 0.0
    applied = AppliedEffect(key, {name: Estimate(value, 0.0, "")})
    found = SimpleNamespace(hypothesis=SimpleNamespace(model=model, free=(applied,)))
    assert witnessed(SimpleNamespace(motions=()), found) is possible  # type: ignore[arg-type]
