"""Recordings on the ground: a right model scores the noise floor; one line says what does not fit."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.simulation.make import having
from workbench.comparison import compare, replay_of
from workbench.core import EffectKey, InputError, Recording
from workbench.effects import load_model
from workbench.recordings import load_recording, save_recording
from workbench.report.json import comparison_dict
from workbench.rigs import Plate, VirtualLeg, plate_experiments

MODEL = load_model("leg_on_plate")


@cache
def clean(seed: int = 4) -> tuple[Recording, ...]:
    """Press, step and slide, 1 s each."""
    return tuple(VirtualLeg(seed=seed, plate=Plate()).run(plate_experiments(duration=1.0)[:3]))


def test_a_right_model_scores_the_noise_floor() -> None:
    result = compare(MODEL, clean())
    assert result.consistent
    assert result.error == pytest.approx(result.noise_error, rel=0.2)
    for entry in result.recordings:
        np.testing.assert_allclose(entry.position_rmse, entry.position_noise, rtol=0.4)
        assert entry.ground_force_rmse is not None and entry.ground_force_rmse.shape == (3,)
    shown = comparison_dict(result)["recordings"][0]
    assert len(shown["ground_force_rmse"]) == len(shown["ground_force_noise"]) == 3
    assert any(
        "no foot slips, so only a lower limit of the ground's friction is known: 0." in note
        for note in result.notes
    )


def test_a_wrong_ground_is_far_above_it() -> None:
    soft = having(MODEL, EffectKey("contact_compliance", None), stiffness=3e4, damping=150.0)
    slippery = having(MODEL, EffectKey("ground_friction", None), coefficient=0.4)
    for model in (soft, slippery):
        result = compare(model, clean())
        assert not result.consistent and result.error > 2.0 * result.noise_error


def test_coordinates_and_columns_are_those_of_the_recording(tmp_path) -> None:
    back = np.linalg.inv(MODEL.transmission)
    joint = [
        replace(
            r,
            coordinates="joint",
            signals={
                "position": r.position @ back.T,
                "velocity": r.velocity @ back.T,
                "torque_measured": r.signals["torque_measured"] @ MODEL.transmission,
            },
        )
        for r in clean()[:1]
    ]
    (run,) = replay_of(MODEL, clean()[:1]).run([MODEL])
    (same,) = replay_of(MODEL, joint).run([MODEL])
    valid = slice(20, None)
    away = same[0].position @ MODEL.transmission.T - run[0].position
    assert np.sqrt(np.mean(away[valid] ** 2)) < 1e-4  # noise is weighed by other axes
    save_recording(clean()[0], tmp_path / "press.toml")
    again = load_recording(tmp_path / "press.toml")
    np.testing.assert_array_equal(again.extra["ground_force"], clean()[0].extra["ground_force"])


def test_in_the_air_the_same_model_knows_no_ground() -> None:
    quick = VirtualLeg(seed=1).run(plate_experiments(duration=0.5)[:1])
    assert compare(MODEL, quick).error == compare(load_model("leg"), quick).error


def test_what_does_not_fit_is_told_in_one_line(tmp_path) -> None:
    recording = clean()[0]
    force = recording.extra["ground_force"]
    refused = {
        "model 'leg' has no ground; add a \\[ground\\] table": (load_model("leg"), recording),
        "6 columns, and model 'leg_on_plate' has 1 feet": (
            MODEL,
            replace(recording, extra={"ground_force": np.hstack([force, force])}),
        ),
        "joint_compliance@knee has a state that no sensor shows": (
            having(MODEL, EffectKey("joint_compliance", "knee"), stiffness=60.0, damping=0.1),
            recording,
        ),
        "the base moves, but that of model 'leg_on_plate' is fixed; give its MJCF a <freejoint/>": (
            MODEL,
            replace(recording, extra={**recording.extra, "base_position": force}),
        ),
        "no torque was recorded": (
            MODEL,
            replace(recording, signals={k: recording.signals[k] for k in ("position", "velocity")}),
        ),
    }
    for line, (model, given) in refused.items():
        with pytest.raises(InputError, match=line):
            compare(model, [given])
    save_recording(recording, tmp_path / "press.toml")
    text = (tmp_path / "press.toml").read_text()
    (tmp_path / "press.toml").write_text(text.replace('    "ground_force_2",\n', ""))
    with pytest.raises(InputError, match=r"columns.ground_force.*not a multiple of three; give fx, fy, fz"):
        load_recording(tmp_path / "press.toml")
