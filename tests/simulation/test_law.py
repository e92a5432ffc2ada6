"""The torque of a stated loop along a measured motion is the torque that the loop gave."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from tests.bench_arm import FAST, KP, bench_arm, logged
from workbench.core import Recording
from workbench.effects import compile_plant, load_model
from workbench.recordings import noise_levels
from workbench.simulation import Track, law_torque, smooth_track


def track_of(log: Recording) -> Track:
    levels = noise_levels(log)
    return smooth_track(log, None, np.eye(3), levels.position_std, levels.velocity_std, 40.0)


def test_a_loop_at_the_log_s_rate_gives_its_own_command(tmp_path: Path) -> None:
    file = bench_arm(tmp_path)
    log = logged(file, FAST, seconds=4.0)
    torque = law_torque(log, compile_plant(load_model(file)), track_of(log))
    command = log.signals["torque_command"]
    off = np.sqrt(np.mean((torque - command)[50:-50] ** 2, axis=0))
    # noise of the sensors goes into the command, and not into the smoothed motion
    assert (off < 0.01 * np.sqrt(np.mean(command**2, axis=0)) + 0.02).all()


def test_a_loop_faster_than_its_log_is_known_by_its_mean(tmp_path: Path) -> None:
    """The mean of what was commanded between the rows is the truth."""
    file = bench_arm(tmp_path)
    plant = compile_plant(load_model(file))
    slow, every = (logged(file, FAST, seconds=4.0, log_s=s, loop_s=0.001, held=False) for s in (0.01, 0.001))
    told = replace(slow, timing=replace(slow.timing, reference_held=False))
    torque = law_torque(told, plant, track_of(told))
    mean = every.signals["torque_command"].reshape(-1, 10, 3).mean(axis=1)
    off = np.sqrt(np.mean((torque - mean)[10:-10] ** 2, axis=0))
    assert (off < 0.02 * np.sqrt(np.mean(mean**2, axis=0)) + 0.02).all()


def test_a_reference_still_between_rows_is_late_by_half(tmp_path: Path) -> None:
    file = bench_arm(tmp_path)
    plant, log = compile_plant(load_model(file)), logged(file, FAST, seconds=4.0, log_s=0.01, loop_s=0.001)
    held, smooth = (
        law_torque(replace(log, timing=replace(log.timing, reference_held=h)), plant, track_of(log))
        for h in (True, False)
    )
    rate = np.gradient(log.signals["position_reference"], 0.01, axis=0)
    late = -KP * rate * 0.0045  # nine of ten ticks, half of that on the average
    np.testing.assert_allclose((held - smooth)[5:-5], late[5:-5], atol=0.1 * np.abs(late).max())


def test_a_delay_moves_the_torque_by_any_part_of_a_row(tmp_path: Path) -> None:
    file = bench_arm(tmp_path)
    model, log = load_model(file), logged(file, FAST, seconds=3.0)
    track = track_of(log)
    late = replace(model, actuators=replace(model.actuators, delay_s=0.003))
    now, then = (law_torque(log, compile_plant(m), track) for m in (model, late))
    np.testing.assert_allclose(then[2:], 0.5 * (now[1:-1] + now[:-2]), atol=1e-9)
    assert (then[0] == 0.0).all()
