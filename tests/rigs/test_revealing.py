"""Experiments beyond the demo's start in the hold posture, keep off the stops and do what they are for."""

import numpy as np
import pytest

from workbench.core import Recording
from workbench.rigs import PERFECT, Experiment, HiddenEffect, VirtualLeg
from workbench.rigs.experiments import HOLD
from workbench.rigs.revealing import (
    dither,
    range_sweep,
    revealing_experiments,
    speed_ladder,
    steps,
    work_and_rest,
)

TO_JOINT = np.array([[1.0, -1.0], [0.0, 1.0]])  # of row vectors


def log(experiment: Experiment, *hidden: HiddenEffect) -> Recording:
    return VirtualLeg(hidden, sensors=PERFECT).run([experiment])[0]


def test_they_keep_off_the_stops_and_the_limits() -> None:
    for experiment in revealing_experiments():
        np.testing.assert_allclose(experiment.reference[0], HOLD, atol=1e-9)
        assert len(experiment.reference) == len(experiment.feedforward)
        shorter = Experiment(
            experiment.name,
            experiment.reference[-5000:],
            experiment.feedforward[-5000:],
            experiment.excitation,
        )
        recording = log(shorter)
        hip, knee = (recording.position @ TO_JOINT).T
        assert np.abs(hip).max() < 1.6 and knee.min() > 0.35 and knee.max() < 2.6
        assert np.abs(recording.signals["torque_measured"]).max() < 24.0
        assert np.abs(recording.velocity).max() < 40.0
    names = [experiment.name for experiment in revealing_experiments()]
    assert len(set(names)) == len(names)


def test_the_sweep_passes_every_angle_both_ways_at_one_speed() -> None:
    reference = range_sweep().reference
    for joint in range(2):
        speed = np.diff(reference[:, joint]) / 1e-3
        moving = np.abs(speed) > 1e-6
        np.testing.assert_allclose(np.quantile(np.abs(speed[moving]), [0.01, 0.99]), 0.35, rtol=1e-6)
        grid = np.linspace(*np.quantile(reference[:, joint], [0.02, 0.98]), 20)
        for way in (1, -1):
            passed = reference[:-1, joint][way * speed > 1e-6]
            assert np.abs(passed[:, None] - grid).min(axis=0).max() < 1e-3


def test_dither_grows_from_presliding_to_slip() -> None:
    friction = HiddenEffect("coulomb_friction", "hip", parameters={"torque": 0.3})
    moved = np.abs(log(dither(duration=6.0), friction).velocity[:, 0])
    settled = 300  # rows: torque comes late, and the leg sags before
    assert moved[settled:1500].max() == 0.0 and moved[-1000:].max() > 0.1


def test_steps_ask_for_most_of_the_torque() -> None:
    torque = log(steps(sizes=(0.42,))).signals["torque_measured"]
    assert np.all(np.abs(torque).max(axis=0) > 18.0)


@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_a_ladder_repeats_its_path_at_several_speeds(joint: str) -> None:
    experiment = speed_ladder(joint, speeds=(0.5, 1.0))
    index = ("hip", "knee").index(joint)
    speeds = np.abs(np.diff(experiment.reference[:, index])) / 1e-3
    assert {0.5, 1.0} <= set(np.round(speeds, 6))
    assert np.ptp(experiment.reference[:, index]) == pytest.approx(0.7, abs=2e-3)
    assert np.ptp(experiment.reference[:, 1 - index]) == 0.0


def test_work_warms_and_rest_cools() -> None:
    torque = log(work_and_rest(spell=3.0, spells=2)).signals["torque_measured"]
    work, rest = torque[1000:2500], torque[4000:]
    assert np.all(np.std(work, axis=0) > 3.0) and np.all(np.std(rest, axis=0) < 0.05)
