"""What no explanation may be, whatever it does for the data."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.core import EffectKey, Estimate
from workbench.diagnosis.acceptance import degrades_holdout
from workbench.diagnosis.data import Data
from workbench.diagnosis.significance import identifiable, is_significant
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
        _, upper = effect_named(effect).parameters.bounds(model, Placement.of(model, key))
        value = float(upper[0]) + 1.0
    elif effect == "viscous_damping":
        lower, _ = effect_named(effect).parameters.bounds(model, Placement.of(model, key))
        value = float(lower[0])
        assert value < 0.0
    applied = AppliedEffect(key, {name: Estimate(value, 0.0, "")})
    found = SimpleNamespace(hypothesis=SimpleNamespace(model=model, free=(applied,)))
    assert identifiable(SimpleNamespace(motions=()), found) is possible  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("order", "spring", "possible"),
    [
        (3.0, False, True),  # one period of a ripple by itself
        (3.0, True, False),  # with a spring it follows any spring that is no straight line
        (24.0, True, True),
    ],
)
def test_a_wave_beside_a_spring_needs_a_way_no_curve_has(order: float, spring: bool, possible: bool) -> None:
    model = load_model("leg")
    wave = {
        "torque": Estimate(0.2, 0.0, ""),
        "order": Estimate(order, 0.0, ""),
        "phase": Estimate(0.0, 0.0, ""),
    }
    straight = {"stiffness": Estimate(0.7, 0.0, ""), "rest": Estimate(0.1, 0.0, "")}
    effects = [AppliedEffect(EffectKey("cogging", "hip"), wave)]
    effects += [AppliedEffect(EffectKey("parallel_spring", "hip"), straight)] if spring else []
    effects += [AppliedEffect(EffectKey("parallel_spring", "knee"), straight)]  # of another axis
    found = SimpleNamespace(hypothesis=SimpleNamespace(model=model, free=tuple(effects)))
    arc = np.linspace(-1.1, 1.1, 50)
    motions = (SimpleNamespace(along=lambda place: (arc, arc, arc)),)
    assert identifiable(SimpleNamespace(motions=motions), found) is possible  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("effect", "parameters", "clear"),
    [
        ("coulomb_friction", {"torque": (0.2, 0.01)}, True),
        ("coulomb_friction", {"torque": (0.02, 0.01)}, False),
        ("torque_constant_error", {"gain": (1.01, 0.01)}, False),
        ("torque_constant_error", {"gain": (0.9, 0.01)}, True),
        ("current_loop_lag", {"time_constant": (5e-6, 2e-5)}, False),
        ("current_loop_lag", {"time_constant": (1e-3, 2e-5)}, True),
        # the order of a ripple says nothing where its size is none, nor does its phase
        ("cogging", {"torque": (2e-4, 2e-4), "order": (12.0, 0.1), "phase": (3.0, 0.1)}, False),
        ("cogging", {"torque": (0.2, 2e-3), "order": (12.0, 0.1), "phase": (0.0, 0.1)}, True),
        ("backlash", {"gap": (0.01, 0.001), "stiffness": (400.0, 300.0)}, True),
        # that all of an inertia is meant is stated, not estimated
        ("link_inertia_error", {"inertia": (0.6, 0.25), "proportion": (1.0, 0.0)}, False),
    ],
)
def test_what_may_be_nothing_is_not_named(
    effect: str, parameters: dict[str, tuple[float, float]], clear: bool
) -> None:
    estimates = {k: Estimate(value, std, "") for k, (value, std) in parameters.items()}
    assert is_significant(AppliedEffect(EffectKey(effect, "knee"), estimates)) is clear


@pytest.mark.parametrize(
    ("before", "after", "spoilt"),
    [
        (1.0, 4.0, True),  # it was at the noise
        (1.0, 2.0, False),
        (2.0, 4.0, False),  # it lacked something before: other causes may still be missing
    ],
)
def test_what_held_out_motion_had_right_may_not_be_lost(before: float, after: float, spoilt: bool) -> None:
    recordings = tuple(SimpleNamespace(valid=np.ones(100, bool)) for _ in range(2))
    squares = np.ones((2, 2, 1))
    data = Data(recordings, 1, None, squares, 0.0 * squares, (), np.ones((2, 1)))  # type: ignore[arg-type]
    current, found = (
        SimpleNamespace(mean_squares=squares * [[[1.0]], [[times]]]) for times in (before, after)
    )
    assert degrades_holdout(found, current, data) is spoilt  # type: ignore[arg-type]
    alone = Data(recordings[:1], 1, None, squares[:1], squares[:1], (), np.ones((2, 1)))  # type: ignore[arg-type]
    assert not degrades_holdout(found, current, alone)  # type: ignore[arg-type]
