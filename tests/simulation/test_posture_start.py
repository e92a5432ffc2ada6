"""A log that begins in the middle of a motion, of a mechanism whose transmission changes, in a soft loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench import compare, frf
from workbench.core import Controller, Recording, Timing
from workbench.models import read_model
from workbench.simulation import PosturePlant, SensorNoise, as_recording, held_posture, run_posture
from workbench.simulation.posture_start import refined

FIRST = 300
_OWN = read_model("four_bar")
MODEL = replace(_OWN, actuators=replace(_OWN.actuators, damping=(0.01, 0.01)))
SOFT = Controller("pd", "joint", kp=(20.0, 20.0), kd=(0.3, 0.3), period_s=0.002)


@pytest.fixture(scope="module", params=[0, 1])
def log(request: pytest.FixtureRequest) -> tuple[Recording, np.ndarray]:
    """The second half of a run with noise; and its true start, (2, n), of drives."""
    design = frf.multisine(
        MODEL.axes, name="m", period_s=2.0, rms=0.5, f_min_hz=0.5, f_max_hz=5.0, rate_hz=500.0,
        hold=held_posture(MODEL, {}), mixing="orthogonal", periods=1, transient_periods=0, realisations=1,
        phases="schroeder", driven="torque_feedforward", seed=1,
    )  # fmt: skip
    asked = replace(as_recording(MODEL, design, 0), controller=SOFT)
    sensors = SensorNoise(np.full(2, 4e-4), np.zeros(2), np.full(2, 0.005), np.full(2, 0.01), request.param)
    clean, whole = run_posture(PosturePlant(MODEL), asked, [None, sensors])
    cut = replace(whole.rows(slice(FIRST, None)), timing=Timing(initial_at_rest=False))
    return cut, np.stack([clean.position[FIRST], clean.signals["velocity"][FIRST]])


def test_its_own_model_is_at_the_noise(log: tuple[Recording, np.ndarray]) -> None:
    result = compare(MODEL, [log[0]])
    assert result.error < 1.06 * result.noise_error  # 1.09 and 1.11 from the first rows alone


def test_a_start_goes_no_further_than_its_doubt_allows(log: tuple[Recording, np.ndarray]) -> None:
    cut, true = log
    gone = true + np.array([[0.3], [8.0]])  # nowhere near: a model that fits there is not believed
    moved = refined(gone, cut, lambda starts: np.repeat(starts[:, :1], len(cut), axis=1))
    assert np.abs(moved - gone)[0].max() < 0.01
