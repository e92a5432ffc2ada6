"""Effects of every stage of the machine that a leg hides, alone and in pairs: each is named with its size."""

from __future__ import annotations

from dataclasses import replace

import pytest

from workbench.core import EffectKey, Estimate, Recording
from workbench.diagnosis import diagnose
from workbench.effects import load_model
from workbench.models import AppliedEffect
from workbench.rigs import HiddenEffect, VirtualLeg, slow_sweep

from .rig import recordings
from .test_diagnose import check_named

#: Effects through each stage, small enough to need a good model, and what may be named beside them.
HIDDEN = [
    HiddenEffect("viscous_damping", "knee", "joint", {"damping": 0.15}),
    HiddenEffect("torque_bias", "hip", parameters={"torque": -0.4}),
    HiddenEffect("torque_constant_error", "knee", parameters={"gain": 0.85}),
    HiddenEffect("command_delay", parameters={"time": 0.0007}),
    HiddenEffect("reflected_inertia", "hip", parameters={"inertia": 0.008}),
    HiddenEffect("parallel_spring", "hip", parameters={"stiffness": 2.0, "rest": -0.2}),
    HiddenEffect("linkage_gravity", parameters={"g1": 0.4, "g2": 0.25}),
]


@pytest.mark.parametrize("hidden", HIDDEN, ids=lambda h: f"{h.effect}@{h.axis}")
def test_it_is_named_with_its_size(hidden: HiddenEffect) -> None:
    check_named(hidden)


def test_the_parts_of_friction_are_told_one_after_the_other() -> None:
    training, held_out = recordings(
        HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.15}),
        HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.05}),
    )
    found = diagnose(load_model("leg"), training, held_out)
    assert {f.key.effect for f in found.findings} == {"coulomb_friction", "viscous_damping"}
    for f in found.findings:
        assert f.holdout_error_before is not None and f.holdout_error_after is not None
        assert f.holdout_error_after < f.holdout_error_before


def test_what_a_short_motion_cannot_show_is_not_excited() -> None:
    training, held_out = recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.2}))
    still = [_held(r) for r in training]
    model = load_model("leg")
    found = diagnose(model, still, [_held(held_out[0])])
    silent = {(k.effect, k.axis) for k in found.not_excited}
    assert ("stribeck_friction", "knee") in silent
    assert all(f.key not in found.not_excited for f in found.findings)


def _held(recording: Recording) -> Recording:
    """The same recording with only its first second, in which little moves."""
    rows = 1000
    return replace(
        recording,
        time=recording.time[:rows],
        signals={k: v[:rows] for k, v in recording.signals.items()},
        valid=recording.valid[:rows],
    )


def test_a_wrong_parameter_is_corrected_by_an_increment() -> None:
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.5})
    training, held_out = recordings(hidden)
    guess = AppliedEffect(EffectKey("coulomb_friction", "knee"), {"torque": Estimate(0.2, 0.0, "N*m")})
    found = diagnose(load_model("leg").with_effect(guess), training, held_out)
    assert found.findings[0].key == guess.key
    assert found.findings[0].parameters["torque"].value == pytest.approx(0.3, rel=0.03)


def test_a_held_out_recording_that_shows_nothing_does_not_judge() -> None:
    hidden = HiddenEffect("torque_saturation", "hip", parameters={"limit": 2.0})
    training, _ = recordings(hidden)
    quiet = VirtualLeg((hidden,), seed=6).run([slow_sweep(duration=6.0)])
    found = diagnose(load_model("leg"), training, quiet)
    assert found.verdict == "missing_effect"
    assert found.findings[0].key == EffectKey("torque_saturation", "hip")
    assert found.findings[0].parameters["limit"].value == pytest.approx(2.0, rel=0.01)
    assert any("in turn" in line for line in found.findings[0].evidence)


def test_a_limit_that_held_out_motion_never_reaches_is_found() -> None:
    hidden = (
        HiddenEffect("torque_saturation", "knee", parameters={"limit": 4.2}),
        HiddenEffect("encoder_offset", "hip", parameters={"angle": 0.06}),
    )
    training, held_out = recordings(*hidden)
    found = diagnose(load_model("leg"), training, held_out)
    keys = {f.key for f in found.findings}
    # a limit that falls with speed fits better as long as the offset is missing
    assert keys == {EffectKey("torque_saturation", "knee"), EffectKey("encoder_offset", "hip")}


def test_what_no_catalogue_lists_is_unexplained() -> None:
    outsider = HiddenEffect("random_walk_torque", "hip", parameters={"torque": 0.4, "time_constant": 0.3})
    training, held_out = recordings(outsider)
    found = diagnose(load_model("leg"), training, held_out)
    assert (found.verdict, found.findings) == ("unexplained", ())
    assert found.unexplained_fraction > 0.1
    assert found.where[0].axis == outsider.axis and found.next_experiment
    assert (
        f"Most of the remaining error is in the {outsider.axis} {found.where[0].signal}, "
        in found.next_experiment
    )
