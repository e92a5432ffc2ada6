"""What the log shows of the true motion: late, bent, filtered; and a loop with other gains than it states."""

import itertools

import numpy as np
import pytest

from tests.rigs.test_hidden import wave
from workbench.core import Recording, SimulationError
from workbench.rigs import PERFECT, Experiment, HiddenEffect, VirtualLeg
from workbench.rigs.experiments import HOLD
from workbench.rigs.integrate import Integrator
from workbench.rigs.machine import Machine


def log(*hidden: HiddenEffect, experiment: Experiment | None = None) -> Recording:
    return VirtualLeg(hidden, sensors=PERFECT).run([experiment or wave(600)])[0]


def truth(recording: Recording, at: float = 0.0, parts: int = 1) -> np.ndarray:
    """Motors' angles and speeds (N, 4) under the logged torque, `at` [s] after each row.

    With `parts` also between rows, (N parts, 4).
    """
    leg = Integrator(Machine())
    state, seen = leg.start(HOLD[0], HOLD[0] + HOLD[1]), []
    for u1, u2 in recording.signals["torque_measured"]:
        fine = state
        for _ in range(parts):
            seen.append(leg.motors(leg.advance(fine, u1, u2, at) if at else fine))
            fine = leg.advance(fine, u1, u2, 1e-3 / parts)
        state = leg.advance(state, u1, u2, 1e-3)
    return np.array(seen)


def shown(recording: Recording) -> np.ndarray:
    return np.hstack([recording.position, recording.velocity])


@pytest.mark.parametrize("late", [1e-3, 2e-3, 0.4e-3, 2.7e-3])
def test_position_and_velocity_are_late(late: float) -> None:
    recording = log(HiddenEffect("sensor_delay", parameters={"time": late}))
    rows = int(np.ceil(late / 1e-3 - 1e-9))
    expected = truth(recording, rows * 1e-3 - late)[:-rows]
    np.testing.assert_allclose(shown(recording)[rows:], expected, atol=1e-9)
    np.testing.assert_allclose(recording.position[0], [HOLD[0], HOLD.sum()], atol=1e-12)
    np.testing.assert_array_equal(recording.velocity[:rows], 0.0)


@pytest.mark.parametrize("lag", [0.5e-3, 5e-3])
def test_velocity_passes_a_first_order_filter(lag: float) -> None:
    recording = log(HiddenEffect("velocity_filter_lag", "knee", parameters={"time_constant": lag}))
    parts = 50
    fine, filtered, expected = truth(recording, parts=parts)[:, 3], 0.0, []
    kept = np.exp(-1e-3 / parts / lag)
    for row, (now, then) in enumerate(itertools.pairwise(fine)):
        if row % parts == 0:
            expected.append(filtered)
        filtered = 0.5 * (now + then) * (1 - kept) + filtered * kept
    np.testing.assert_allclose(recording.velocity[: len(expected), 1], expected, atol=2e-4)
    np.testing.assert_allclose(
        np.delete(shown(recording), 3, axis=1), np.delete(truth(recording), 3, axis=1), atol=1e-9
    )


MAPS = {
    "encoder_offset": ({"angle": 0.03}, lambda q: (q + 0.03, 1.0 + 0 * q)),
    "encoder_scale": ({"scale": 1.02}, lambda q: (1.02 * q, 1.02 + 0 * q)),
    "encoder_eccentricity": (
        {"amplitude": 0.02, "phase": 0.7},
        lambda q: (q + 0.02 * np.sin(q + 0.7), 1 + 0.02 * np.cos(q + 0.7)),
    ),
}


@pytest.mark.parametrize(("axis", "index"), [("hip", 0), ("knee", 1)])
@pytest.mark.parametrize("effect", MAPS)
def test_an_encoder_maps_position_and_velocity_alike(effect: str, axis: str, index: int) -> None:
    parameters, bent = MAPS[effect]
    recording = log(HiddenEffect(effect, axis, parameters=parameters))
    true = truth(recording)
    position, slope = bent(true[:, index])
    np.testing.assert_allclose(recording.position[:, index], position, atol=1e-9)
    np.testing.assert_allclose(recording.velocity[:, index], slope * true[:, 2 + index], atol=1e-8)
    np.testing.assert_allclose(recording.position[:, 1 - index], true[:, 1 - index], atol=1e-9)


def expected_command(recording: Recording, kp: tuple[float, float], kd: tuple[float, float]) -> np.ndarray:
    """Joint PD of what was logged, at the ticks (N / 3, 2)."""
    to_joint = np.linalg.inv([[1.0, 0.0], [1.0, 1.0]])
    q, v = recording.position @ to_joint.T, recording.velocity @ to_joint.T
    return ((np.array(kp) * (recording.signals["position_reference"] - q) - np.array(kd) * v) @ to_joint)[::3]


def test_the_controller_uses_what_is_logged() -> None:
    recording = log(
        HiddenEffect("sensor_delay", parameters={"time": 1.3e-3}),
        HiddenEffect("velocity_filter_lag", "hip", parameters={"time_constant": 4e-3}),
        HiddenEffect("encoder_offset", "knee", parameters={"angle": 0.02}),
    )
    expected = expected_command(recording, (50.0, 50.0), (1.5, 1.5))
    np.testing.assert_allclose(recording.signals["torque_command"][::3], expected, atol=1e-10)


def test_a_loop_with_other_gains_states_the_nominal_ones() -> None:
    wrong = HiddenEffect("controller_gain_error", "knee", parameters={"kp_scale": 0.8, "kd_scale": 1.3})
    recording = log(wrong)
    expected = expected_command(recording, (50.0, 0.8 * 50.0), (1.5, 1.3 * 1.5))
    np.testing.assert_allclose(recording.signals["torque_command"][::3], expected, atol=1e-10)
    assert recording.controller.kp == (50.0, 50.0) and recording.controller.kd == (1.5, 1.5)


@pytest.mark.parametrize(
    "nothing",
    [
        HiddenEffect("sensor_delay", parameters={"time": 0.0}),
        HiddenEffect("velocity_filter_lag", "hip", parameters={"time_constant": 0.0}),
        HiddenEffect("controller_gain_error", "hip", parameters={"kp_scale": 1.0, "kd_scale": 1.0}),
        HiddenEffect("encoder_offset", "hip", parameters={"angle": 0.0}),
        HiddenEffect("encoder_scale", "knee", parameters={"scale": 1.0}),
        HiddenEffect("encoder_eccentricity", "knee", parameters={"amplitude": 0.0, "phase": 0.3}),
        HiddenEffect("link_length_error", "hip", parameters={"length": 0.0}),
    ],
    ids=lambda effect: effect.effect,
)
def test_a_neutral_parameter_changes_nothing(nothing: HiddenEffect) -> None:
    nominal = log()
    for signal, values in log(nothing).signals.items():
        np.testing.assert_array_equal(values, nominal.signals[signal])


def test_two_filters_on_one_velocity_are_refused() -> None:
    lag = HiddenEffect("velocity_filter_lag", "hip", parameters={"time_constant": 4e-3})
    with pytest.raises(SimulationError, match="room for one velocity filter"):
        VirtualLeg([lag, lag])
