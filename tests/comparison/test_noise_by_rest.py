"""Noise of a speed that no log holds, from how far the machine trembles."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.comparison import compare
from workbench.comparison.closed_loop import ClosedLoop
from workbench.comparison.replay_of import replay_of
from workbench.core import Recording
from workbench.effects import load_model

NOISE, TICKS = 0.1, 10  # rad/s at each tick of the loop; ticks in a row


def logs(folder: Path, noise: float) -> list[Recording]:
    slow = {"seconds": 8.0, "log_s": 0.001 * TICKS, "loop_s": 0.001, "positions_alone": True}
    machine = bench_arm(folder)
    made = [logged(machine, tones, seed=k, speed_noise=noise, **slow) for k, tones in enumerate((SLOW, FAST))]
    loop = replace(made[0].controller, velocity="sensor")
    return [replace(r, controller=loop, timing=replace(r.timing, reference_held=True)) for r in made]


def level(folder: Path, recordings: list[Recording], **wrong: float) -> np.ndarray:
    """What a model with these numbers tells; noise of a row acts as long as that of all its ticks."""
    model = load_model(bench_arm(folder, "model", **wrong))
    replay = replay_of(model, recordings)
    assert isinstance(replay, ClosedLoop)
    return replay.with_noise(model, 0).noise.levels.velocity_std * np.sqrt(TICKS)


def test_the_level_is_that_of_the_sensor(tmp_path: Path) -> None:
    assert level(tmp_path, logs(tmp_path, NOISE)) == pytest.approx(NOISE, rel=0.2)


def test_fast_motion_in_a_slow_log_is_no_noise_of_the_encoder(tmp_path: Path) -> None:
    """Windows of a few rows take what the machine does for noise; the rest has 50 urad."""
    recordings, model = logs(tmp_path, 0.0), load_model(bench_arm(tmp_path, "model"))
    replay = replay_of(model, recordings)
    assert isinstance(replay, ClosedLoop)
    assert (replay.noise.levels.position_std > 7e-5).all()
    assert replay.with_noise(model, 0).noise.levels.position_std == pytest.approx(5e-5, rel=0.15)


def test_without_noise_there_is_hardly_any(tmp_path: Path) -> None:
    assert (level(tmp_path, logs(tmp_path, 0.0)) < 0.15 * NOISE).all()


def test_what_a_model_misses_is_not_taken_for_noise(tmp_path: Path) -> None:
    """On an axis that lacks little it is what it is; on one that lacks much it is not told, or bounded."""
    told = level(tmp_path, logs(tmp_path, NOISE), lift_damping=1.6, bend_armature=0.1)
    assert told[0] == pytest.approx(NOISE, rel=0.3)
    assert (told < 2.0 * NOISE).all()


def test_a_right_model_is_at_the_noise_and_a_wrong_one_is_not(tmp_path: Path) -> None:
    noisy = logs(tmp_path, NOISE)
    right, wrong = (
        compare(load_model(bench_arm(tmp_path, "model", lift_damping=damping)), noisy)
        for damping in (0.8, 1.6)
    )
    assert right.consistent and right.error == pytest.approx(right.noise_error, rel=0.2)
    assert not wrong.consistent and wrong.error > 1.5 * wrong.noise_error
