"""The bench's shaft is the paper's actuator, and its log is late by the drive's delay."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from workbench.core import Excitation, InputError
from workbench.rigs import HiddenEffect
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


HIDDEN = (
    HiddenEffect("torque_constant_error", "hip", parameters={"gain": 0.9}),
    HiddenEffect("reflected_inertia", "hip", parameters={"inertia": 0.004}),
    HiddenEffect("coulomb_friction", "hip", parameters={"torque": 0.3}),
    HiddenEffect("coulomb_friction", "knee", "joint", {"torque": 9.0}),
    HiddenEffect("payload_mass", None, parameters={"mass": 9.0}),
)


def test_the_drive_hides_on_the_bench_what_it_hides_in_the_leg() -> None:
    t = 1e-3 * np.arange(600)
    log = VirtualBench(sensors=PERFECT, hidden=HIDDEN).run({"a": 2.0 * np.sin(20.0 * t)}, NOISE)[0]
    torque, w = (log.signals[k][:, 0] for k in ("torque_measured", "velocity"))
    acceleration = np.gradient(w, 1e-3)
    moving = (np.abs(w) > 0.2)[1:-1] & (np.abs(np.diff(torque, 2)) < 1e-12)  # amid a command that is held
    left = 0.0202 * acceleration + 0.0972 * w + 0.3 * np.sign(w) - 0.9 * torque
    assert moving.sum() > 100 and np.abs(left[1:-1][moving]).max() < 2e-3
    nominal, knee = (
        VirtualBench(sensors=PERFECT, hidden=hidden, axis="knee").run({"a": t}, NOISE)[0]
        for hidden in ((), HIDDEN)
    )
    np.testing.assert_array_equal(nominal.position, knee.position)


def test_it_sticks_below_its_friction_and_comes_to_rest() -> None:
    weak = VirtualBench(sensors=PERFECT, hidden=HIDDEN).run({"a": np.full(300, 0.32)}, NOISE)[0]
    assert not weak.position.any()  # 0.9 of it is less than 0.3
    push = np.where(np.arange(900) < 100, 1.0, 0.0)
    log = VirtualBench(sensors=PERFECT, hidden=HIDDEN).run({"a": push}, NOISE)[0]
    assert log.position[-1, 0] > 0.05 and not log.signals["velocity"][-200:].any()


def test_what_a_drive_by_itself_cannot_hide_is_refused() -> None:
    with pytest.raises(InputError, match="cogging"):
        VirtualBench(hidden=(HiddenEffect("cogging", "hip"),))
