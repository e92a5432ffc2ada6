"""Where no loop is known, effects are named by the torque that the measured motion needs."""

from __future__ import annotations

from dataclasses import replace

import pytest

from workbench.core import Controller, EffectKey, InputError, Recording
from workbench.diagnosis import diagnose, improve
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

from .rig import recordings

BLIND = replace(load_model("leg"), controller=Controller())


def blind(*hidden: HiddenEffect, seed: int = 5) -> tuple[list[Recording], list[Recording]]:
    """The leg's recordings as somebody has them who does not know its loop."""
    training, held_out = recordings(*hidden, seed=seed)
    forgotten = [[replace(r, controller=Controller()) for r in part] for part in (training, held_out)]
    return forgotten[0], forgotten[1]


HIDDEN = [
    HiddenEffect("coulomb_friction", "knee", "joint", {"torque": 0.2}),
    HiddenEffect("torque_constant_error", "hip", parameters={"gain": 0.9}),
    HiddenEffect("payload_mass", None, parameters={"mass": 0.05}),
    HiddenEffect("sensor_delay", None, parameters={"time": 0.0015}),
    HiddenEffect("parallel_spring", "knee", "joint", {"stiffness": 1.5, "rest": 0.9}),
]


@pytest.mark.parametrize("hidden", HIDDEN, ids=lambda h: f"{h.effect}@{h.axis}")
def test_names_the_hidden_effect_and_its_size(hidden: HiddenEffect) -> None:
    training, held_out = blind(hidden)
    result, better = improve(BLIND, training, held_out)
    key = EffectKey(hidden.effect, hidden.axis, hidden.location)
    assert [s.key for s in result.steps] == [key] and better.effects[-1].key == key
    assert result.holdout_error_after is not None and result.holdout_error_before is not None
    assert result.holdout_error_after < 0.5 * result.holdout_error_before
    for name, value in hidden.parameters.items():
        estimate = result.steps[0].parameters[name]
        assert abs(estimate.value - value) < max(4 * estimate.std, 0.03 * abs(value)), (name, estimate)


def test_a_right_model_is_consistent_and_says_what_cannot_show() -> None:
    training, held_out = blind()
    found = diagnose(BLIND, training, held_out)
    assert (found.verdict, found.findings) == ("consistent", ())
    silent = {k.effect for k in found.not_excited}
    assert {"controller_gain_error", "command_delay", "torque_saturation", "velocity_filter_lag"} <= silent
    assert not {"coulomb_friction", "reflected_inertia", "torque_bias"} & silent


def test_what_no_catalogue_lists_is_unexplained() -> None:
    tone = {"torque": 0.4, "frequency": 3.7, "phase": 0.3}
    outsider = HiddenEffect("periodic_disturbance", "knee", parameters=tone)
    training, held_out = blind(outsider)
    found = diagnose(BLIND, training, held_out)
    assert (found.verdict, found.findings) == ("unexplained", ())
    assert found.where[0].axis == outsider.axis and found.next_experiment


def test_neither_loop_nor_torque_is_refused_with_a_remedy() -> None:
    training, _ = blind()
    torques = ("torque_command", "torque_measured")
    bare = replace(training[0], signals={k: v for k, v in training[0].signals.items() if k not in torques})
    with pytest.raises(InputError, match="neither the loop nor a torque is known"):
        diagnose(BLIND, [bare])
