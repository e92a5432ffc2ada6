"""The virtual leg logs what recording-format says, when it says."""

from pathlib import Path

import numpy as np
import pytest

from workbench.core import Excitation, InputError, SimulationError
from workbench.recordings import load_recording
from workbench.rigs import (
    PERFECT,
    Experiment,
    HiddenEffect,
    Sensors,
    VirtualLeg,
    chirp,
    demo_experiments,
    slow_sweep,
)
from workbench.rigs.experiments import HOLD


def step_experiment(torque: float, rows: int = 60) -> Experiment:
    """Holds the posture, and from row 30 adds `torque` to motor 1."""
    feedforward = np.zeros((rows, 2))
    feedforward[30:, 0] = torque
    return Experiment("step", np.tile(HOLD, (rows, 1)), feedforward, Excitation("hold"))


def test_the_run_starts_at_rest_at_the_first_reference() -> None:
    (recording,) = VirtualLeg(sensors=PERFECT).run([step_experiment(0.0)])
    np.testing.assert_allclose(recording.position[0], [HOLD[0], HOLD[0] + HOLD[1]], atol=1e-12)
    np.testing.assert_array_equal(recording.velocity[0], 0.0)


def test_torque_is_the_command_three_rows_late_and_zero_before() -> None:
    (recording,) = VirtualLeg(sensors=PERFECT).run([step_experiment(2.0)])
    command, torque = recording.signals["torque_command"], recording.signals["torque_measured"]
    np.testing.assert_array_equal(torque[:3], 0.0)
    np.testing.assert_array_equal(torque[3:], command[:-3])


@pytest.mark.parametrize("sensors", [PERFECT, Sensors()])
def test_the_command_is_joint_pd_on_what_was_logged(sensors: Sensors) -> None:
    (recording,) = VirtualLeg(seed=4, sensors=sensors).run([step_experiment(2.0)])
    ticks = slice(0, None, 3)
    to_joint = np.linalg.inv([[1.0, 0.0], [1.0, 1.0]])
    q, v = recording.position[ticks] @ to_joint.T, recording.velocity[ticks] @ to_joint.T
    joint_torque = 50.0 * (recording.signals["position_reference"][ticks] - q) - 1.5 * v
    expected = joint_torque @ to_joint + recording.signals["torque_feedforward"][ticks]  # tau_p = J^-T tau_s
    command = recording.signals["torque_command"]
    np.testing.assert_allclose(command[ticks], expected, atol=1e-12)
    np.testing.assert_array_equal(command, np.repeat(command[ticks], 3, axis=0))


def test_the_drive_clips_and_the_command_does_not() -> None:
    (recording,) = VirtualLeg(sensors=PERFECT).run([step_experiment(40.0)])
    assert recording.signals["torque_command"].max() > 39.0
    assert recording.signals["torque_measured"].max() == 24.0


def test_the_closed_loop_settles_where_virtual_work_says() -> None:
    """At rest motor torque is gravity's slope: g1 sin q1, g2 sin q2."""
    (recording,) = VirtualLeg(sensors=PERFECT).run([step_experiment(0.0, rows=1500)])
    q, torque = recording.position[-1], recording.signals["torque_measured"][-1]
    np.testing.assert_allclose(torque, [1.850411 * np.sin(q[0]), 0.274007 * np.sin(q[1])], atol=1e-5)


def test_sensor_noise_has_the_stated_size() -> None:
    rows = 9000
    still = Experiment("still", np.tile(HOLD, (rows, 1)), np.zeros((rows, 2)), Excitation("hold"))
    (recording,) = VirtualLeg(seed=1).run([still])
    counts = recording.position / (2 * np.pi / 2**14)
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-9)
    assert np.diff(recording.velocity[1000:], axis=0).std() / np.sqrt(2) == pytest.approx(0.015, rel=0.02)
    jump_free = np.arange(rows - 1) % 3 != 2  # the command is held over these
    steps = np.diff(recording.signals["torque_measured"], axis=0)[jump_free]
    assert steps.std() / np.sqrt(2) == pytest.approx(0.02, rel=0.02)


def test_same_seed_same_log_other_seed_other_log() -> None:
    first, again, other = (VirtualLeg(seed=s).run([step_experiment(1.0)])[0] for s in (7, 7, 8))
    np.testing.assert_array_equal(first.velocity, again.velocity)
    assert np.abs(first.velocity - other.velocity).max() > 0.01


def test_a_written_log_reads_back_and_keeps_the_secret(tmp_path: Path) -> None:
    leg = VirtualLeg([HiddenEffect("coulomb_friction", "knee", "actuator", {"torque": 0.3})], seed=2)
    experiment = slow_sweep(1.0)
    (written,) = leg.record_to(tmp_path, [experiment])
    (recording,) = leg.run([experiment])
    read = load_recording(written)
    for signal, values in recording.signals.items():
        np.testing.assert_allclose(read.signals[signal], values, atol=1e-6)
    assert (read.rig, read.axes, read.controller) == ("leg", ("hip", "knee"), recording.controller)
    assert "friction" not in written.read_text() and "hidden" not in repr(recording)
    with pytest.raises(InputError):
        leg.record_to(tmp_path, [experiment])


def test_the_demo_set_is_six_recordings_of_known_length() -> None:
    experiments = demo_experiments(seed=1)
    assert [e.name for e in experiments] == [
        "chirp_hip",
        "chirp_knee",
        "multisine_sum",
        "multisine_diff",
        "slow",
        "validation",
    ]
    assert [len(e.reference) for e in experiments] == [8000, 8000, 11000, 11000, 15000, 6000]
    for experiment in experiments[:4]:
        np.testing.assert_allclose(experiment.reference[0], HOLD)
    np.testing.assert_allclose(
        experiments[2].feedforward[:5000], experiments[2].feedforward[5000:10000], atol=1e-9
    )


def test_a_leg_that_runs_away_is_an_error() -> None:
    with pytest.raises(SimulationError, match="ran away in 'step'"):
        VirtualLeg([HiddenEffect("viscous_damping", "hip", "actuator", {"damping": -5.0})]).run(
            [step_experiment(5.0, rows=1000)]
        )


@pytest.mark.parametrize("row", [0.2e-3, 0.5e-3])
def test_finer_rows_show_the_same_motion(row: float) -> None:
    experiment, ratio = chirp("knee", duration=0.5, f_max=5.0), round(1e-3 / row)
    leg = VirtualLeg(sensors=PERFECT)
    coarse, fine = leg.run([experiment])[0], leg.run([experiment.at_period(row)])[0]
    assert fine.period == pytest.approx(row) and len(fine) == ratio * len(coarse)
    for signal in ("position", "velocity", "torque_command"):
        np.testing.assert_allclose(fine.signals[signal][::ratio], coarse.signals[signal], atol=1e-7)


@pytest.mark.parametrize(("row", "loop"), [(1e-3, 5e-3), (1e-3, 1e-3), (0.2e-3, 0.2e-3)])
def test_the_loop_runs_at_its_own_rate(row: float, loop: float) -> None:
    """200 Hz to 5 kHz: the command stands between ticks, and the recording states the period."""
    leg = VirtualLeg(sensors=PERFECT, control_period=loop)
    (recording,) = leg.run([step_experiment(1.0, rows=600).at_period(row)])
    assert recording.controller.period_s == loop
    ticks = round(loop / row)
    command = recording.signals["torque_command"]
    np.testing.assert_array_equal(command, np.repeat(command[::ticks], ticks, axis=0))
    assert np.abs(recording.velocity[-1]).max() < 1.0


def test_a_loop_between_rows_is_refused() -> None:
    with pytest.raises(InputError, match="not a whole number of rows"):
        VirtualLeg(control_period=2.5e-3).run([step_experiment(0.0)])
