"""Where a run begins: at rest at the first reference, or where the first rows were."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core import Controller, Recording
from workbench.simulation.initial_state import initial_state

LOOP = Controller("pd", "joint", kp=(35.0,), kd=(1.2,), period_s=0.001)
STEP = 2 * np.pi / 2**15


def started(sag: float, period: float) -> np.ndarray:
    """The state (2,) in which the run of a log begins, of an axis that weight holds off its reference."""
    t = np.arange(round(6.0 / period)) * period
    reference = 0.3 + 0.4 * np.sin(2 * np.pi * 1.3 * t)
    follows = 0.3 + 0.4 * np.sin(2 * np.pi * 1.3 * np.maximum(t - 0.03, 0.0)) + sag
    position = np.round(follows / STEP) * STEP
    signals = {"position": position[:, None], "position_reference": reference[:, None]}
    recording = Recording("log", ("tilt",), "joint", t, signals, ("rad",), controller=LOOP)
    one = np.eye(1)
    return initial_state(recording, LOOP, reference[:, None], one, one)[:, 0]


@pytest.mark.parametrize("period", [0.02, 0.01, 0.005])
def test_positions_alone_in_few_rows_say_where_a_run_began(period: float) -> None:
    """A sag of 14 mrad, taken for none, was half a second of error in a model without fault."""
    position, _ = started(0.0143, period)
    assert position == pytest.approx(0.3143, abs=2 * STEP)


@pytest.mark.parametrize("period", [0.01, 0.005, 0.001])
def test_a_jump_of_the_reference_finds_the_machine_at_rest(period: float) -> None:
    """Rows of an axis that speeds up from rest say no speed; a parabola through them said one."""
    rng = np.random.default_rng(1)
    t = np.arange(round(4.0 / period)) * period
    late = np.maximum(t - 0.001, 0.0)
    moved = 0.4 * (1.0 - np.cos(3.0 * late)) * np.exp(-late)
    position = -0.364 + moved + 3e-5 * rng.standard_normal(len(t))
    reference = -0.4 + 0.3 * np.sin(4.0 * t)
    signals = {"position": position[:, None], "position_reference": reference[:, None]}
    recording = Recording("log", ("tilt",), "joint", t, signals, ("rad",), controller=LOOP)
    first = initial_state(recording, LOOP, reference[:, None], np.eye(1), np.eye(1))[:, 0]
    assert first == pytest.approx([-0.364, 0.0], abs=2e-4)


@pytest.mark.parametrize("seed", range(3))
def test_a_loop_that_acts_late_found_the_machine_at_rest(seed: int) -> None:
    """An encoder that errs, rows of 1 ms and ticks of 3: a jerk begins up to two ticks late."""
    loop = Controller("pd", "joint", kp=(50.0,), kd=(1.5,), period_s=0.003)
    t = np.arange(4000) * 0.001
    noise = 1.1e-4 * np.random.default_rng(seed).standard_normal(len(t))
    position = 0.5 - 40.0 * np.maximum(t - 0.004, 0.0) ** 2 * np.exp(-20.0 * t) + noise
    reference = 0.44 + 0.1 * np.sin(3.0 * t)
    signals = {"position": position[:, None], "position_reference": reference[:, None]}
    recording = Recording("log", ("tilt",), "joint", t, signals, ("rad",), controller=loop)
    first = initial_state(recording, loop, reference[:, None], np.eye(1), np.eye(1))[:, 0]
    assert first == pytest.approx([0.5, 0.0], abs=4e-4)


@pytest.mark.parametrize("period", [0.01, 0.001])
def test_a_recording_that_begins_in_motion_begins_in_motion(period: float) -> None:
    rng = np.random.default_rng(2)
    t = np.arange(round(4.0 / period)) * period
    position = 0.2 + 0.3 * np.sin(3.0 * t + 0.4) + 3e-5 * rng.standard_normal(len(t))
    reference = 0.2 + 0.3 * np.sin(3.0 * (t + 0.02) + 0.4)
    signals = {"position": position[:, None], "position_reference": reference[:, None]}
    recording = Recording("log", ("tilt",), "joint", t, signals, ("rad",), controller=LOOP)
    first = initial_state(recording, LOOP, reference[:, None], np.eye(1), np.eye(1))[:, 0]
    assert first[0] == pytest.approx(0.2 + 0.3 * np.sin(0.4), abs=2e-4)
    assert first[1] == pytest.approx(0.9 * np.cos(0.4), abs=0.02)


def test_what_rounding_makes_is_no_other_start() -> None:
    assert started(0.4 * STEP, 0.02) == pytest.approx([0.3, 0.0], abs=1e-12)
