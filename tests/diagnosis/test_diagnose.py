"""Hidden effects are named, with their size; what is not in the catalogue is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import workbench as wb
from workbench.core import EffectKey, Estimate, InputError, Recording
from workbench.diagnosis import diagnose, improve
from workbench.effects import load_model
from workbench.models import AppliedEffect, Linkage
from workbench.recordings import load_recordings
from workbench.rigs import HiddenEffect, VirtualLeg, slow_sweep

from ..data_helpers import LEG
from .rig import recordings

#: Effects through each stage, small enough to need a good model, and what may be named beside them.
HIDDEN = [
    HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.25}),
    HiddenEffect("viscous_damping", "knee", "joint", {"damping": 0.15}),
    HiddenEffect("torque_bias", "hip", parameters={"torque": -0.4}),
    HiddenEffect("torque_constant_error", "knee", parameters={"gain": 0.85}),
    HiddenEffect("command_delay", parameters={"time": 0.0007}),
    HiddenEffect("reflected_inertia", "hip", parameters={"inertia": 0.008}),
    HiddenEffect("payload_mass", parameters={"mass": 0.08}),
    HiddenEffect("parallel_spring", "hip", parameters={"stiffness": 2.0, "rest": -0.2}),
    HiddenEffect("linkage_gravity", parameters={"g1": 0.4, "g2": 0.25}),
]


@pytest.mark.parametrize("hidden", HIDDEN, ids=lambda h: f"{h.effect}@{h.axis}")
def test_names_the_hidden_effect_and_its_size(hidden: HiddenEffect) -> None:
    training, held_out = recordings(hidden)
    found = diagnose(load_model("leg"), training, held_out)
    key = EffectKey(hidden.effect, hidden.axis, hidden.location)
    assert found.verdict == "missing_effect"
    first = found.findings[0]
    assert len(found.findings) == 1
    assert key in (first.key, *first.indistinguishable_from)
    assert first.holdout_error_before is not None and first.holdout_error_after is not None
    assert first.holdout_error_after < 0.6 * first.holdout_error_before
    assert found.after is not None and found.after.error < 1.1 * found.noise_error
    if hidden.effect == "coulomb_friction":
        assert any("knee is proportional to the sign of speed (slope 0.2" in line for line in first.evidence)
    assert found.evidence == ()  # nothing is left to be explained
    if first.key == key:
        for name, value in hidden.parameters.items():
            estimate = first.parameters[name]
            assert abs(estimate.value - value) < max(4 * estimate.std, 0.03 * abs(value)), (name, estimate)
            assert 0 < estimate.std < 0.2 * abs(value)


def test_a_leg_without_hidden_effect_is_consistent() -> None:
    training, held_out = recordings()
    result, model = improve(load_model("leg"), training, held_out)
    assert (result.verdict, result.steps) == ("consistent", ())
    assert model.effects == load_model("leg").effects
    assert result.diagnosis is not None and result.diagnosis.unexplained_fraction == 0.0


def test_a_log_of_a_few_rows_has_no_verdict() -> None:
    (run, *_), _ = recordings()
    few = replace(
        run, time=run.time[:39], signals={k: v[:39] for k, v in run.signals.items()}, valid=run.valid[:39]
    )
    with pytest.raises(InputError, match="39 rows are too few"):
        diagnose(load_model("leg"), [few])


def test_a_machine_that_never_moved_has_no_verdict() -> None:
    (log, *_), _ = recordings()
    still = {name: np.zeros_like(values) for name, values in log.signals.items()}
    with pytest.raises(InputError, match="no axis moves"):
        diagnose(load_model("leg"), [replace(log, signals=still)])


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


def test_what_no_catalogue_lists_is_unexplained() -> None:
    outsider = HiddenEffect("random_walk_torque", "hip", parameters={"torque": 0.4, "time_constant": 0.3})
    training, held_out = recordings(outsider)
    found = diagnose(load_model("leg"), training, held_out)
    assert (found.verdict, found.findings) == ("unexplained", ())
    assert found.unexplained_fraction > 0.1
    assert found.where[0].axis == outsider.axis and found.next_experiment
    assert f"Most of the remaining error is in the {found.where[0].signal} around" in found.next_experiment


def test_what_follows_a_stranger_is_added_only_when_asked_for() -> None:
    """Two springs follow one between the axes to the noise; what they leave goes with both positions."""
    hidden = HiddenEffect("cross_spring", parameters={"stiffness": 0.69, "rest": -0.158})
    training, held_out = recordings(hidden)
    node, better = improve(load_model("leg"), training, held_out, nearest=True)
    found = node.diagnosis
    assert found is not None
    assert (found.verdict, found.findings) == ("unexplained", ())
    assert found.shapes[0].share > 0.95
    assert found.shapes[0].quantities == ("position", "the position of hip")
    assert any("a description, not a cause" in line for line in found.evidence)
    assert (node.verdict, node.nearest, better.name) == ("unexplained", True, "leg_nearest")
    assert [a.key for a in better.effects[-len(node.steps) :]] == [s.key for s in node.steps]
    assert node.holdout_error_after is not None and node.holdout_error_before is not None
    assert node.holdout_error_after < 0.3 * node.holdout_error_before
    assert wb.compare(better, training).error == pytest.approx(node.error_after, rel=1e-6)
    assert node.held_out is not None
    before, after = node.held_out
    assert [e.recording.name for e in after.recordings] == [r.name for r in held_out]
    assert before.error == pytest.approx(node.holdout_error_before, rel=1e-6)
    assert after.error == pytest.approx(node.holdout_error_after, rel=1e-6)


def test_what_only_held_out_motion_shows_is_no_consistent_model() -> None:
    friction = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.4})
    (training, _), (_, held_out) = recordings(), recordings(friction)
    node, _ = improve(load_model("leg"), training, held_out)
    found = node.diagnosis
    assert found is not None
    assert (node.verdict, found.verdict, node.steps, found.findings) == ("unexplained", "unexplained", (), ())
    assert "fit those and hold out others" in found.evidence[0]


def test_the_ladder_from_kin_only() -> None:
    training, held_out = recordings()
    model = load_model("leg_kin_only")
    result, better = improve(model, training, held_out)
    names = [s.key.effect for s in result.steps]
    assert names == ["actuator_inertia_coupling", "linkage_inertia", "linkage_gravity"]
    errors = [result.error_before, *(s.error for s in result.steps)]
    held = [result.holdout_error_before, *(s.holdout_error for s in result.steps)]
    assert all(np.diff(errors) < 0) and all(np.diff([h for h in held if h is not None]) < 0)
    assert result.verdict == "consistent"
    assert [e.key.effect for e in better.effects] == names


def test_a_linkage_that_was_not_identified_is_fitted() -> None:
    training, held_out = recordings()
    act = load_model("leg_s3n_act")
    unknown = replace(act, linkage=Linkage(identified=False))
    result, better = improve(unknown, training, held_out)
    fitted = [e for e in better.effects if e.key.effect == "linkage_inertia"]
    rivals = {k.effect for s in result.steps for k in s.indistinguishable_from}
    assert result.error_after < 0.3 * result.error_before
    assert fitted or "linkage_inertia" in rivals or "payload_mass" in {s.key.effect for s in result.steps}


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


def test_friction_in_data_from_an_independent_simulator() -> None:
    folder = LEG / "friction"
    training = load_recordings([folder / "chirp_knee.toml", folder / "slow.toml"])
    held_out = load_recordings([folder / "validation.toml"])
    found = diagnose(load_model("leg"), training, held_out)
    torque = found.findings[0].parameters["torque"]
    assert found.findings[0].key == EffectKey("coulomb_friction", "knee")
    assert abs(torque.value - 0.25447) < 1.96 * torque.std
    assert torque.std < 0.005


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
