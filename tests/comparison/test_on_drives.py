"""Recordings of a mechanism whose transmission changes, held against it from its drives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.mechanism_log import multisines
from workbench import compare
from workbench.comparison import replay_of
from workbench.core import Controller, EffectKey, Estimate, InputError, Recording
from workbench.models import AppliedEffect, read_model
from workbench.s3n import on_drives
from workbench.simulation import SensorNoise

MODEL = read_model("four_bar")


@pytest.fixture(scope="module")
def log() -> Recording:
    """Two seconds of both drives, with the noise of sensors."""
    sensors = SensorNoise(np.full(2, 1e-5), np.zeros(2), np.full(2, 0.01), np.full(2, 0.01), 3)
    return multisines(MODEL, period_s=2.0, f_min_hz=0.5, rate_hz=500.0, noise=sensors)


def _with(effect: str, **values: float) -> AppliedEffect:
    return AppliedEffect(EffectKey(effect, "knee"), {k: Estimate(v, 0.0, "") for k, v in values.items()})


@pytest.mark.parametrize(
    "effect, number, along", [("viscous_damping", "damping", False), ("torque_bias", "torque", True)]
)
def test_only_the_right_model_is_at_the_noise(log: Recording, effect: str, number: str, along: bool) -> None:
    idle, wrong = (MODEL.with_effect(_with(effect, **{number: size})) for size in (0.0, 0.2))
    right = compare(idle, [log])
    assert right.error < 1.3 * right.noise_error
    assert any("transmission changes" in note for note in right.notes) == along
    assert np.isfinite(right.recordings[0].position_rmse).all() != along
    assert compare(wrong, [log]).error > 3.0 * right.noise_error


def test_a_log_without_its_loop_is_compared_along_its_motion(log: Recording) -> None:
    loose = Controller("unknown")
    result = compare(replace(MODEL, controller=loose), [replace(log, controller=loose)])
    assert result.error < 1.3 * result.noise_error
    assert any("transmission changes" in note for note in result.notes)


def test_logs_that_show_no_torque_of_the_drives_are_refused(log: Recording) -> None:
    model = on_drives(MODEL)
    with pytest.raises(InputError, match="in joint coordinates"):
        replay_of(model, [replace(log, coordinates="joint")])
    bare = replace(log, signals={k: x for k, x in log.signals.items() if "torque" not in k})
    with pytest.raises(InputError, match="no torque is known"):
        replay_of(model, [bare])
