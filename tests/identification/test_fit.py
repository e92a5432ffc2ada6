"""Parametric fits recover what was simulated, as surely as they say, and say when they are not enough."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.frf.machines import DRIVE, LEG, drive_recording, leg_recordings
from tests.frf.sure import within
from workbench.core import InputError
from workbench.frf import estimate
from workbench.frf.sampled import response, second_order
from workbench.identification import fit_actuator, fit_leg

POSTURES = ((-0.55, 0.497), (-0.2, 1.4))


def away(fit, truth) -> np.ndarray:
    """Each parameter's distance from the truth in its own deviations."""
    return np.array([(fit.parameters[n].value - v) / fit.parameters[n].std for n, v in truth.items()])


@pytest.mark.parametrize("delay", [0.003, 0.0034, 0.0, 0.0105])
def test_a_drive_is_recovered(delay) -> None:
    truth = {**DRIVE, "delay": delay}
    fit = fit_actuator(estimate([drive_recording(delay=delay)]))
    assert np.abs(away(fit, truth)).max() < 4
    assert fit.parameters["inertia"].std < 3e-3 * truth["inertia"]
    assert fit.parameters["delay"].std < 3e-5 and fit.parameters["delay"].unit == "s"
    assert fit.adequate and "The model fits" in fit.sentence


def test_half_a_row_of_hold_is_no_delay() -> None:
    """A plain fit of a log at 1 kHz returns 3.5 ms for a delay of 3.0 ms."""
    frf = estimate([drive_recording()])
    assert frf.hold_s == pytest.approx(1e-3)
    assert fit_actuator(frf).parameters["delay"].value == pytest.approx(3.0e-3, abs=5e-5)
    plain = fit_actuator(replace(frf, hold_s=None))
    assert plain.parameters["delay"].value == pytest.approx(3.5e-3, abs=5e-5)


def test_intervals_of_a_drive_are_calibrated() -> None:
    distances, fine = [], []
    for seed in range(25):
        fit = fit_actuator(estimate([drive_recording(seed, periods=2)], transient_periods=1))
        distances.append(away(fit, DRIVE))
        fine.append(fit.adequate)
    distances = np.array(distances)
    assert np.mean(fine) > 0.9
    # 75 numbers of unit variance: between 0.77 and 1.25 with a chance of 99 %, some margin about that
    assert 0.65 < np.sqrt(np.mean(distances**2)) < 1.35
    assert np.abs(distances.mean(axis=0)).max() < 0.8


def test_the_measured_torque_has_no_command_delay_and_says_so() -> None:
    r = drive_recording()
    late = np.concatenate([np.zeros((3, 1)), r.signals["torque_command"][:-3]])
    frf = estimate([r.with_signals(torque_measured=late)], input="torque_measured")
    fit = fit_actuator(replace(frf, hold_s=1e-3))
    assert fit.parameters["delay"].value == pytest.approx(0.0, abs=5e-5)
    assert any("after the command's delay" in n for n in fit.notes)


def test_a_missing_spring_is_noticed_and_widens_the_intervals() -> None:
    frf = estimate([drive_recording(periods=6)])
    sprung = second_order(
        0.0162 * np.eye(1), 0.0972 * np.eye(1), 2.0 * np.eye(1), 0.003, np.array([[0.0, 1.0]])
    )
    bent = replace(
        frf, response=frf.response - fit_actuator(frf).responses[0] + response(sprung, frf.omega, 1e-3)
    )
    fit = fit_actuator(bent)
    assert not fit.adequate and "too simple" in fit.sentence
    assert fit.judgement.cost > 2 * fit.judgement.expected and not fit.judgement.white
    good = fit_actuator(frf)
    assert fit.parameters["damping"].std > 3 * good.parameters["damping"].std
    assert any("weighted by the model's residual" in n for n in fit.notes)


@pytest.mark.parametrize("output", ["velocity", "position"])
def test_a_leg_is_recovered_from_two_postures(output) -> None:
    frfs = [estimate(leg_recordings(q, seed=k), output=output) for k, q in enumerate(POSTURES)]
    fit = fit_leg(frfs)
    assert np.abs(away(fit, LEG)).max() < 4
    for name, share in (("M11", 0.003), ("M12", 0.02), ("M22", 0.003), ("delay", 0.005)):
        assert fit.parameters[name].std < share * LEG[name]
    assert fit.adequate


def test_a_leg_in_joint_coordinates() -> None:
    frf = estimate(leg_recordings(POSTURES[0]))
    j = np.array([[1.0, 0.0], [1.0, 1.0]])
    back = np.linalg.inv(j)
    turned = frf.transformed(back, back.T, outputs=frf.outputs, inputs=frf.inputs)
    joint = replace(turned, coordinates="joint", posture=tuple(back @ np.array(frf.posture)))
    with pytest.raises(InputError, match="joint coordinates"):
        fit_leg(joint)
    fit, plain = fit_leg(joint, transmission=j), fit_leg(frf)
    for name in LEG:
        assert fit.parameters[name].value == pytest.approx(plain.parameters[name].value, rel=1e-4)
        assert fit.parameters[name].std == pytest.approx(plain.parameters[name].std, rel=1e-2)


def test_responses_of_the_wrong_kind_are_refused() -> None:
    leg = estimate(leg_recordings(POSTURES[0]))
    for refused in (
        lambda: fit_actuator(leg),
        lambda: fit_leg([]),
        lambda: fit_leg(leg.select(["hip"], ["hip"])),
        lambda: fit_actuator(estimate([drive_recording()], input="velocity", output="position")),
    ):
        with pytest.raises(InputError) as caught:
            refused()
        assert caught.value.remedy
    one = estimate([drive_recording()])
    with pytest.raises(InputError, match="numbers for"):
        fit_actuator(within(one, 0.4, 0.6))
    with pytest.raises(InputError, match="covariance"):
        fit_actuator(replace(one, dof=np.zeros(len(one))))
