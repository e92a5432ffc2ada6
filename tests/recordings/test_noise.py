"""Sensor noise is found within a few per cent, whatever the motion; truth of the reference leg is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from exam.degrade import degrade
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.data_helpers import leg_examples
from workbench.core import Recording
from workbench.recordings import load_recording, noise_levels
from workbench.recordings.quantisation import quantisation_step

STEP = 2 * np.pi / 16384


def test_reference_leg() -> None:
    found = [noise_levels(load_recording(path)) for path in leg_examples()]
    for noise in found:
        np.testing.assert_allclose(noise.position_resolution, STEP, rtol=1e-4)
        np.testing.assert_allclose(noise.position_std, STEP / np.sqrt(12), rtol=1e-4)
        np.testing.assert_allclose(noise.velocity_std, 0.015, rtol=0.08)
        np.testing.assert_allclose(noise.torque_std, 0.02, rtol=0.08)
    assert np.mean([n.velocity_std for n in found]) == pytest.approx(0.015, rel=0.03)
    assert np.mean([n.torque_std for n in found]) == pytest.approx(0.02, rel=0.03)


@pytest.mark.parametrize("every", [2, 4, 5])
def test_noise_at_ticks_that_no_row_shows_is_not_the_torque_s(every: int) -> None:
    """There the torque answers noise that sensors had between rows, 0.05 N m of it; its own is 0.02 N m."""
    found = [noise_levels(degrade(load_recording(path), every=every)).torque_std for path in leg_examples()]
    assert np.median(found) == pytest.approx(0.02, rel=0.2)


def drive(rate: float, hold_s: float = 0.005, seconds: float = 6.0, seed: int = 0) -> Recording:
    """One inertia with Coulomb friction under random held torques: kinks in velocity, steps in torque."""
    rng = np.random.default_rng(seed)
    fine = 5
    hold = max(1, round(hold_s * rate))
    rows = int(seconds * rate)
    command = np.repeat(rng.normal(0, 1.0, rows // hold + 1), hold)[:rows]
    command += np.sin(2 * np.pi * 3 * np.arange(rows) / rate)
    held = np.repeat(command[::hold], hold)[:rows]
    delay = round(0.005 * rate)
    reached = np.concatenate([np.zeros(delay), held])[:rows]
    torque = np.empty(rows * fine)
    state = 0.0
    pull = 1 - np.exp(-1 / (fine * rate * 0.0008))
    for k, target in enumerate(np.repeat(reached, fine)):
        state += pull * (target - state)
        torque[k] = state
    v, q, dt = 0.0, 0.0, 1 / (rate * fine)
    vs, qs = np.empty(rows), np.empty(rows)
    for k in range(rows * fine):
        if k % fine == 0:
            vs[k // fine], qs[k // fine] = v, q
        free = v + dt * (torque[k] - 0.2 * v - 2.0 * q) / 0.02
        v = np.sign(free) * max(0.0, abs(free) - dt * 0.3 / 0.02)
        q += dt * v
    measured = {
        "position": np.round(qs / STEP) * STEP,
        "velocity": vs + rng.normal(0, 0.03, rows),
        "torque_measured": torque[::fine] + rng.normal(0, 0.05, rows),
        "torque_command": held,
    }
    time = np.arange(rows) / rate
    return Recording(
        "drive", ("a",), "actuator", time, {k: x[:, None] for k, x in measured.items()}, ("rad",)
    )


@pytest.mark.parametrize("rate", [200.0, 1000.0, 5000.0])
def test_friction_steps_and_rates_do_not_count_as_noise(rate: float) -> None:
    noise = noise_levels(drive(rate, seconds=6.0 if rate < 5000 else 2.0))
    assert noise.position_std[0] == pytest.approx(STEP / np.sqrt(12), rel=0.01)
    assert noise.torque_std[0] == pytest.approx(0.05, rel=0.08)
    assert noise.velocity_std[0] == pytest.approx(0.03, rel=0.1)


def test_a_torque_logged_in_coarse_steps_has_their_noise() -> None:
    r, step = drive(1000.0, seconds=6.0), 0.5
    slow = np.sin(np.pi * r.time) + 0.02 * np.random.default_rng(3).standard_normal(len(r))
    coarse = (np.round(slow / step) * step)[:, None]  # stands still in most windows
    found = noise_levels(r.with_signals(torque_measured=coarse)).torque_std[0]
    assert found == pytest.approx(step / np.sqrt(12), rel=0.15)


def test_signals_that_were_not_measured_are_nan() -> None:
    r = drive(1000.0, seconds=1.0)
    only = {k: v for k, v in r.signals.items() if k != "torque_measured"}
    noise = noise_levels(Recording("r", ("a",), "actuator", r.time, only, ("rad",), derived=("velocity",)))
    assert np.isnan(noise.torque_std[0]) and np.isnan(noise.velocity_std[0])
    assert np.isfinite(noise.position_std[0])


def test_masked_rows_do_not_count() -> None:
    r = drive(1000.0, seconds=3.0)
    broken = r.velocity.copy()
    valid = np.ones(len(r), bool)
    valid[::700] = False
    broken[::700] = 1e3
    masked = Recording(
        "r", ("a",), "actuator", r.time, {**r.signals, "velocity": broken}, ("rad",), valid=valid
    )
    assert noise_levels(masked).velocity_std[0] == pytest.approx(0.03, rel=0.1)


def test_an_axis_that_never_moves_is_unknown() -> None:
    r = drive(1000.0, seconds=1.0)
    still = r.with_signals(position=np.full((len(r), 1), 0.3))
    assert np.isnan(noise_levels(still).position_resolution[0])


def test_analogue_position_noise() -> None:
    t = np.arange(4000) / 1000
    q = np.sin(2 * np.pi * t) + np.random.default_rng(0).normal(0, 1e-3, 4000)
    r = Recording("r", ("a",), "actuator", t, {"position": q[:, None]}, ("rad",))
    noise = noise_levels(r)
    assert noise.position_resolution[0] == 0.0
    assert noise.position_std[0] == pytest.approx(1e-3, rel=0.05)


@pytest.mark.parametrize("times", [0.0, 0.5, 1.0, 1.4, 1.7, 2.0, 3.0])
@pytest.mark.parametrize("fast", [False, True])
def test_noise_beside_rounding_is_found_whatever_its_size(times: float, fast: bool) -> None:
    """Between one and two times the rounding it was taken for motion: a floor that was half of what it is."""
    rng, t = np.random.default_rng(3), np.arange(6000) / 1000
    q = 0.3 * np.sin(2 * np.pi * t) + fast * 0.01 * np.sin(2 * np.pi * 8.0 * t**2)
    rounding = STEP / np.sqrt(12)
    q = STEP * np.round((q + rng.normal(0.0, times * rounding, len(t))) / STEP)
    r = Recording("r", ("a",), "actuator", t, {"position": q[:, None]}, ("rad",))
    assert noise_levels(r).position_std[0] == pytest.approx(rounding * np.hypot(1.0, times), rel=0.12)


def test_an_axis_that_hides_its_noise_is_as_noisy_as_its_like() -> None:
    """Of eighteen axes one had half the floor of the others: it lay just below twice the rounding."""
    rng, t = np.random.default_rng(0), np.arange(4000) / 1000
    moved = np.sin(2 * np.pi * t)[:, None] * np.ones(5)
    moved[:, 0] += 3e-4 * np.sin(2 * np.pi * 12.0 * t**2)  # reaches into the bands that tell noise
    q = STEP * np.round((moved + rng.normal(0.0, 1.7e-4, moved.shape)) / STEP)
    names = tuple("abcde")
    noise = noise_levels(Recording("r", names, "actuator", t, {"position": q}, ("rad",) * 5))
    np.testing.assert_allclose(noise.position_std, np.hypot(1.7e-4, STEP / np.sqrt(12)), rtol=0.1)


@settings(max_examples=40)
@given(step=st.floats(1e-6, 1e-2), start=st.floats(-10, 10), seed=st.integers(0, 99))
def test_any_encoder_step_is_found(step: float, start: float, seed: int) -> None:
    counts = np.cumsum(np.random.default_rng(seed).integers(-3, 4, 2000))
    assert quantisation_step(start + counts * step) == pytest.approx(step, rel=1e-3)


@given(seed=st.integers(0, 99))
def test_a_step_is_found_in_a_log_of_few_digits(seed: int) -> None:
    """A fast axis skips many steps, and each row is rounded to a hundredth of one."""
    counts = np.cumsum(np.random.default_rng(seed).integers(-60, 61, 2000))
    assert quantisation_step(np.round(counts * 2 * np.pi / 65536, 6)) == pytest.approx(
        2 * np.pi / 65536, rel=1e-5
    )


def test_no_lattice_in_real_numbers() -> None:
    assert quantisation_step(np.random.default_rng(0).normal(size=3000)) == 0.0


def test_noise_of_speed_that_the_loop_answers_counts_as_noise() -> None:
    """Where damping makes the command of noisy speed, the command must not explain the noise away."""
    rng = np.random.default_rng(5)
    period, rows, sigma = 0.005, 2400, 0.005
    time = np.arange(rows) * period
    wanted = 0.5 * np.sin(2.1 * time) + 0.2 * np.sin(7.3 * time)
    q, v = 0.0, 0.0
    log = np.empty((rows, 3))
    for k in range(rows):
        seen = v + rng.normal(0, sigma)
        command = 60.0 * (wanted[k] - q) - 3.0 * seen
        log[k] = q, seen, command
        for _ in range(10):
            v += 0.1 * period * command / 0.1
            q += 0.1 * period * v
    signals = {"position": log[:, :1], "velocity": log[:, 1:2], "torque_command": log[:, 2:]}
    found = noise_levels(Recording("loop", ("a",), "actuator", time, signals, ("rad",)))
    assert found.velocity_std[0] == pytest.approx(sigma, rel=0.15)


def test_noise_between_gaps_without_room_for_a_long_window() -> None:
    r = drive(1000.0)
    valid = np.arange(len(r)) % 120 != 0
    plain, broken = noise_levels(r), noise_levels(replace(r, valid=valid))
    for name in ("position_std", "velocity_std"):
        np.testing.assert_allclose(getattr(broken, name), getattr(plain, name), rtol=0.3)


def test_a_speed_that_mostly_stands_still_shows_its_rounding() -> None:
    r = drive(1000.0)
    v = np.round(r.velocity / 0.2) * 0.2
    v[500:] = 0.0
    v[-1] = 0.2
    found = noise_levels(replace(r, signals={**r.signals, "velocity": v}))
    assert found.velocity_std[0] == pytest.approx(0.2 / np.sqrt(12), rel=1e-3)
