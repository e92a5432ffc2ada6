"""The bench's shaft is the paper's actuator, and its log is late by the drive's delay."""

import numpy as np
from scipy.integrate import solve_ivp

from workbench.core import Excitation
from workbench.rigs.bench import VirtualBench, shaft_constants
from workbench.rigs.virtual_leg import PERFECT

NOISE = Excitation("multisine")


def test_the_shaft_is_table_one() -> None:
    assert shaft_constants() == (0.0162, 0.0972)


def test_motion_is_that_of_an_independent_integrator() -> None:
    wanted = 2.0 * np.sin(0.05 * np.arange(300)) + 0.3
    recording = VirtualBench(sensors=PERFECT).run({"a": wanted}, NOISE)[0]
    held = np.repeat(wanted[::3], 3)

    def rate(t: float, state: np.ndarray) -> list[float]:
        row = int(np.floor((t - 0.003) / 1e-3 + 1e-9))
        torque = held[row] if row >= 0 else 0.0
        return [state[1], (torque - 0.0972 * state[1]) / 0.0162]

    state, states = np.zeros(2), [np.zeros(2)]
    for k in range(299):
        span = (k * 1e-3, (k + 1) * 1e-3 - 1e-12)
        state = solve_ivp(rate, span, state, rtol=1e-11, atol=1e-13).y[:, -1]
        states.append(state)
    np.testing.assert_allclose(recording.position[:, 0], np.array(states)[:, 0], atol=1e-9)
    np.testing.assert_allclose(recording.signals["velocity"][:, 0], np.array(states)[:, 1], atol=1e-8)


def test_measured_torque_follows_the_command_by_three_ms() -> None:
    recording = VirtualBench(sensors=PERFECT).run({"a": np.arange(60.0) / 10}, NOISE)[0]
    command, measured = (recording.signals[k][:, 0] for k in ("torque_command", "torque_measured"))
    np.testing.assert_array_equal(measured[3:], command[:-3])
    assert (measured[:3] == 0).all()


def test_noise_is_drawn_from_the_seed() -> None:
    wanted = np.ones(90)
    first, again, other = (VirtualBench(seed=s).run({"a": wanted}, NOISE)[0] for s in (1, 1, 2))
    np.testing.assert_array_equal(first.signals["velocity"], again.signals["velocity"])
    assert not np.array_equal(first.signals["velocity"], other.signals["velocity"])
