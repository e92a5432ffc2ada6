"""What sensors show and what controllers ask for is what the equations of their effects say."""

from __future__ import annotations

import numpy as np
import pytest

from tests.effects.cases import CASES, Case, experiment, reference, with_effect
from workbench.effects import SignalStage, compile_plant, load_model
from workbench.models import Placement
from workbench.simulation import TRUE_MOTION, Track, motion_of

SENSORS = [c for c in CASES if c.effect.stage == SignalStage.SENSOR]
CONTROLLERS = [c for c in CASES if c.effect.stage == SignalStage.CONTROLLER]


def true_track(case: Case) -> Track:
    """The motion that a run with the effect makes."""
    run = with_effect(case)
    q, w = (run.extra.get(name, run.signals[name[5:]]) for name in TRUE_MOTION)
    return Track(q, w, np.gradient(w, run.period, axis=0))


@pytest.mark.parametrize("case", SENSORS, ids=str)
def test_the_log_shows_what_the_equation_says(case: Case) -> None:
    run, track, model = with_effect(case), true_track(case), load_model(case.model)
    motion = motion_of(track, run, compile_plant(model), np.eye(model.size))
    coefficients, shape = case.effect.parameters.to_coefficients(dict(case.values))
    answer = case.effect.response(motion, model, Placement.of(model, case.key), shape)
    expected = np.zeros((2, *track.position.shape)) if answer.reading is None else answer.reading
    if answer.readings is not None:
        expected = expected + np.tensordot(coefficients, answer.readings, axes=1)
    assert not answer.columns.any()
    shown = np.stack([run.position - track.position, run.velocity - track.velocity])
    wrong = np.sqrt(np.mean((shown - expected) ** 2, axis=1))
    assert (wrong < 2e-3 * np.sqrt(np.mean(expected**2, axis=1)) + 1e-12).all()
    assert np.abs(shown).max() > 1e-3 * np.ptp(run.position)


@pytest.mark.parametrize("case", SENSORS, ids=str)
def test_a_run_starts_with_the_reading_that_the_log_starts_with(case: Case) -> None:
    run, track = with_effect(case), true_track(case)
    np.testing.assert_allclose(run.position[0], reference(case.model).position[0], atol=1e-9)
    np.testing.assert_array_equal(track.velocity[0], 0.0)


@pytest.mark.parametrize("case", CONTROLLERS, ids=str)
def test_the_command_is_that_of_the_true_gains(case: Case) -> None:
    model = load_model(case.model)
    run = experiment(case.model).with_signals(**with_effect(case).signals)
    motion = motion_of(true_track(case), run, compile_plant(model), np.eye(model.size))
    coefficients, _ = case.effect.parameters.to_coefficients(dict(case.values))
    place = Placement.of(model, case.key)
    assert place is not None
    answer = case.effect.response(motion, model, place, {})
    assert answer.commands is not None and not answer.columns.any()
    every = [motion.law(axis) for axis in range(model.size)]
    cascade = run.controller.kind == "cascade_pv"
    stated = sum(share[1] if cascade else share.sum(axis=0) for share in every)
    period = round((run.controller.period_s or run.period) / run.period)
    ticks = np.arange(len(run)) // period * period
    pushed = run.get("torque_feedforward")
    asked = stated + (0.0 if pushed is None else pushed[ticks])
    change = np.tensordot(coefficients, answer.commands, axes=1)
    if cascade:  # the product of both errors is not linear
        change = change + np.prod(coefficients) * answer.commands[0]
    command = run.signals["torque_command"]
    top = np.multiply(run.controller.gain, run.controller.limit) if cascade else np.inf
    expected = np.clip(asked + change, -top, top)
    # nothing is asked for any more at the last row
    np.testing.assert_allclose(command[:-1], expected[:-1], atol=1e-6 * np.abs(command).max())
    assert np.abs(change).max() > 1e-2 * np.abs(command).max()
