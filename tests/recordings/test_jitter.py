"""A clock that jitters: what the rows say about when they were taken, and when the loop ticked."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from workbench.core import InputError
from workbench.recordings import load_recording, noise_levels
from workbench.recordings.quantisation import quantisation_step
from workbench.recordings.zero_order_hold import (
    held_by,
    nearest_between_steps,
    shared_ticks,
    step_phase,
    ticks,
)

from .test_read import two_axes, with_columns, write_recording

ROWS, PERIOD = 3000, 0.001
LOOP = 0.003
W = 2 * np.pi * 3.0


def commanded(t: np.ndarray) -> np.ndarray:
    """What a loop of 3 ms that ticks at zero holds."""
    return np.sin(0.7 * np.floor(t / LOOP + 1e-9))


def log(path: Path, taken: np.ndarray, stamped: np.ndarray, noise: float = 1e-4) -> Path:
    """Rows taken at one time and stamped with another."""
    path.mkdir(exist_ok=True)
    generator = np.random.default_rng(2)
    wave = [0.3 * np.sin(W * taken + p) + noise * generator.standard_normal(ROWS) for p in (0.0, 1.0)]
    data = {k: np.resize(v, ROWS) for k, v in two_axes().items()}
    data |= {"t": stamped, "q_a": wave[0], "q_b": wave[1], "ff": commanded(taken)}
    data |= {k: W * 0.3 * np.cos(W * taken) for k in data if k.startswith("w_")}
    columns = with_columns(torque_feedforward=["ff", "ff"])
    controller = {"kind": "pd", "kp": [1.0, 1.0], "kd": [0.1, 0.1], "period_s": LOOP}
    return write_recording(path, data, columns=columns, controller=controller)


@pytest.mark.parametrize("size", [0.02, 0.2])
def test_rows_taken_late_are_moved_to_the_clock(tmp_path: Path, size: float) -> None:
    clock = np.arange(ROWS) * PERIOD
    taken = clock + PERIOD * np.clip(size * np.random.default_rng(1).standard_normal(ROWS), -0.45, 0.45)
    r = load_recording(log(tmp_path, taken, taken))
    assert r.period == PERIOD and len(r) == ROWS and "jitter" in r.notes[0] and "resampled" in r.notes[0]
    assert r.late_s == 0.0, "its commands change where it ticks: the loop itself keeps time"
    missed = r.position[:, 0] - 0.3 * np.sin(W * r.time)
    assert np.std(missed) == pytest.approx(1e-4, rel=0.1), "a row keeps the noise that it has"
    np.testing.assert_array_equal(r.signals["torque_feedforward"][:, 0], commanded(clock))


def test_a_loop_that_may_be_late_with_the_rows_counts_as_late(tmp_path: Path) -> None:
    clock = np.arange(ROWS) * PERIOD
    taken = clock + PERIOD * np.clip(0.1 * np.random.default_rng(1).standard_normal(ROWS), -0.45, 0.45)
    path = log(tmp_path, taken, taken)
    table = path.with_name(tomllib.loads(path.read_text())["table"])
    lines = table.read_text().splitlines()
    held = lines[0].split(",").index("ff")
    by_row = commanded(clock)
    rows = [line.split(",") for line in lines[1:]]
    for row, value in zip(rows, by_row, strict=True):
        row[held] = repr(float(value))
    table.write_text("\n".join([lines[0], *map(",".join, rows)]) + "\n")
    assert load_recording(path).late_s == pytest.approx(np.std(taken - clock), rel=0.01)


def test_where_only_the_stamps_are_late_rows_stay_as_they_are(tmp_path: Path) -> None:
    clock = np.arange(ROWS) * PERIOD
    stamped = clock + PERIOD * 0.4 * np.random.default_rng(1).uniform(-1, 1, ROWS)
    r = load_recording(log(tmp_path, clock, stamped))
    exact = load_recording(log(tmp_path / "exact", clock, clock))
    assert r.period == PERIOD and "stamps" in r.notes[0] and r.late_s == 0.0
    for name, signal in exact.signals.items():
        np.testing.assert_array_equal(r.signals[name], signal, err_msg=name)


def test_a_late_stamp_is_no_gap_and_a_missing_row_is_one(tmp_path: Path) -> None:
    clock = np.arange(ROWS) * PERIOD
    stamped = clock + PERIOD * 0.2 * np.clip(np.random.default_rng(1).standard_normal(ROWS), -2.2, 2.2)
    stamped[[700, 701]] = clock[[700, 701]] + np.array([-0.44, 0.44]) * PERIOD
    assert load_recording(log(tmp_path, clock, stamped)).valid is not None
    stamped[701:] += PERIOD
    with pytest.raises(InputError, match="time jumps"):
        load_recording(log(tmp_path / "gap", clock, stamped))


def test_a_logger_that_paused_for_part_of_a_row_lost_none(tmp_path: Path) -> None:
    late = 1.0 + 0.2 * (
        np.random.default_rng(3).random(ROWS) < 0.4
    )  # polls of a controller in fifths of a row
    late[1500] = 1.6
    stamped = PERIOD * np.concatenate([[0.0], np.cumsum(late)[:-1]])
    assert load_recording(log(tmp_path, stamped, stamped)).valid is not None
    stamped[1501:] += PERIOD
    with pytest.raises(InputError, match=r"time jumps by 2\.6 periods"):
        load_recording(log(tmp_path / "gap", stamped, stamped))


@settings(max_examples=25, deadline=None)
@example(phase=0.001, size=0.0, loop=0.002)
@given(phase=st.floats(0.0, 2.9e-3), size=st.floats(0.0, 0.3), loop=st.sampled_from([0.002, 0.003, 0.005]))
def test_any_loop_is_found_between_rows(phase: float, size: float, loop: float) -> None:
    generator = np.random.default_rng(4)
    times = np.arange(2000) * PERIOD + PERIOD * size * generator.uniform(-1, 1, 2000)
    of = generator.standard_normal((2000, 2))

    def held(t: np.ndarray) -> np.ndarray:
        return of[np.floor((t - phase) / loop).astype(int) + 3]

    found = ticks(times, held(times), loop)
    assert found is not None
    amid = phase + loop * (np.arange(3, 300) + 0.5)
    np.testing.assert_array_equal(held_by(times, held(times), *found, amid), held(amid))


def test_nothing_is_interpolated_across_a_step_of_the_torque() -> None:
    generator = np.random.default_rng(4)
    at = np.arange(3000) * PERIOD
    times = at + PERIOD * 0.2 * generator.uniform(-1, 1, 3000)
    smooth = np.sin(W * times)
    torque = np.column_stack([commanded(times) + 0.02 * generator.standard_normal(3000), smooth])
    steps = step_phase(times, torque, LOOP)
    assert steps is not None
    phase, still = steps
    assert min(phase, LOOP - phase) < 0.01 * PERIOD and still.tolist() == [True, False]
    chosen = torque[nearest_between_steps(times, phase, LOOP, at)][:, 0]
    assert np.abs(chosen - commanded(at)).max() < 0.1
    assert step_phase(times, smooth[:, None], LOOP) is None


@pytest.mark.parametrize("size", [0.02, 0.15])
@pytest.mark.parametrize("shift", [-1e-7, 0.0, 1e-7])
def test_rows_at_a_step_by_a_rounded_clock_are_behind_it(size: float, shift: float) -> None:
    """Stamps of 0.05 ms, whose mean is a little off the clock: rows at a tick are beside those before it."""
    late = np.clip(size * np.random.default_rng(6).standard_normal(3000), -0.4, 0.4)
    taken = np.round(PERIOD * (np.arange(3000) + late) / 5e-5) * 5e-5
    torque = commanded(taken)[:, None]
    steps = step_phase(taken + shift, torque, LOOP)
    assert steps is not None
    at = np.arange(3, 2990) * PERIOD
    near = nearest_between_steps(taken + shift, steps[0], LOOP, at)
    lost = np.abs(torque[near, 0] - commanded(at)) > 1e-9
    # where all rows of a tick were taken early or late, there is none to show it
    assert lost.mean() < 0.001


def test_the_steps_of_an_encoder_outlive_a_clock_that_jitters(tmp_path: Path) -> None:
    step = 4e-4
    taken = np.cumsum(np.random.default_rng(4).uniform(0.5, 1.5, ROWS)) * PERIOD
    q = 0.3 * np.sin(W * taken)
    q[1000:2000] = q[1000]  # stands for a while, where most windows show no rounding at all
    data = {k: np.resize(v, ROWS) for k, v in two_axes().items()} | {"t": taken - taken[0]}
    data |= {"q_a": step * np.round(q / step), "q_b": 0.3 * np.cos(W * taken)}
    path = tmp_path / "log"
    path.mkdir()
    r = load_recording(write_recording(path, data))
    assert "resampled" in r.notes[0] and quantisation_step(r.position[:, 0]) == 0.0
    levels = noise_levels(r)
    np.testing.assert_allclose(levels.position_resolution, [step, 0.0], rtol=1e-3)
    assert levels.position_std[0] == pytest.approx(step / np.sqrt(12), rel=0.6)


def every_row(taken: np.ndarray, noise: float = 0.0) -> np.ndarray:
    """What a loop holds that ticks as often as rows are taken, as these rows show it, (N, 2)."""
    tick = np.floor(taken / PERIOD + 1e-9)
    held = np.column_stack([np.sin(0.1 * tick), np.cos(0.13 * tick)])
    return held + noise * np.random.default_rng(5).standard_normal(held.shape)


@pytest.mark.parametrize("size", [0.01, 0.1, 0.3])
def test_rows_taken_before_their_tick_show_the_command_before(tmp_path: Path, size: float) -> None:
    clock = np.arange(ROWS) * PERIOD
    late = np.clip(size * np.random.default_rng(1).standard_normal(ROWS), -0.45, 0.45)
    late[0] = 0.0
    taken = clock + PERIOD * late
    noise = 0.05
    data = {k: np.resize(v, ROWS) for k, v in two_axes().items()} | {"t": taken}
    data |= {"q_a": np.sin(W * taken), "q_b": np.cos(W * taken)}
    data |= {f"ff{i}": x for i, x in enumerate(every_row(taken).T)}
    data |= {f"tau{i}": x for i, x in enumerate(every_row(taken, noise).T)}
    columns = with_columns(torque_feedforward=["ff0", "ff1"], torque_measured=["tau0", "tau1"])
    controller = {"kind": "pd", "kp": [1.0, 1.0], "kd": [0.1, 0.1], "period_s": PERIOD}
    r = load_recording(write_recording(tmp_path, data, columns=columns, controller=controller))
    true, guessed = every_row(clock), r.guessed["torque_feedforward"]
    assert 0.2 < guessed.mean() < 0.3, "a tick is hidden where a row comes late and the next one early"
    moved = r.signals["torque_feedforward"]
    np.testing.assert_allclose(moved[~guessed], true[~guessed], atol=1e-12)
    assert np.abs(moved - true)[1:-1].max() < 0.02, "and there the ticks beside it tell"
    missed = r.signals["torque_measured"] - true
    assert np.std(missed) == pytest.approx(noise, rel=0.1)
    assert noise_levels(r).torque_std == pytest.approx(noise, rel=0.1)


def test_what_stands_still_is_no_loop() -> None:
    generator = np.random.default_rng(6)
    times = np.arange(ROWS) * PERIOD + PERIOD * 0.2 * generator.uniform(-1, 1, ROWS)
    smooth = np.sin(W * times)[:, None]
    assert shared_ticks(times, smooth, PERIOD) is None
    stands = np.where(np.arange(ROWS)[:, None] // 300 % 2 == 0, smooth, 0.5)
    assert shared_ticks(times, stands, PERIOD) is None
