"""A loop that makes its speed of the position: the way it does so is named, and its gains are not blamed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.data_helpers import emps_toml
from workbench.core import Controller, Recording
from workbench.inspection import Remark, inspect
from workbench.recordings import load_recording
from workbench.recordings.velocity import derive_velocity

STEP, HOLD = 0.001, 2


def looped(way: str, late: int = 0, gain: float = 1.0, rows: int = 6000) -> Recording:
    """One axis under a PD law at every second row that takes its speed in this way; no speed is logged."""
    t = np.arange(rows) * STEP
    rng = np.random.default_rng(0)
    f = rng.uniform(0.5, 12.0, 8)
    reference = (0.3 / f * np.sin(2 * np.pi * np.outer(t, f) + rng.uniform(0, 6, 8))).sum(axis=1)
    q, v, command, seen, passed = 0.0, 0.0, 0.0, np.zeros(rows), 0.0
    commands, speeds = np.zeros(rows), np.zeros(rows)
    for k in range(rows):
        seen[k], speeds[k] = np.round(q / 1e-5) * 1e-5, v
        if k % HOLD == 0:
            now, tick = np.maximum(k - HOLD * np.arange(6), 0), HOLD * STEP
            at = seen[now]
            passed += ((at[0] - at[1]) / tick - passed) / 5.0
            speed = {
                "one": (at[late] - at[late + 1]) / tick,
                "two": (at[late] - at[late + 2]) / (2 * tick),
                "four": (at[late] - at[late + 4]) / (4 * tick),
                "low-pass": passed,
            }[way]
            command = 30.0 * (reference[k] - at[late]) - 0.6 * gain * speed
        commands[k] = command
        v += STEP * (command - 0.2 * v) / 0.02
        q += STEP * v
    signals = {
        "position": seen[:, None],
        "velocity": derive_velocity(seen[:, None], STEP),
        "torque_command": commands[:, None],
        "position_reference": reference[:, None],
    }
    law = Controller("pd", "joint", (30.0,), (0.6,), period_s=HOLD * STEP)
    return Recording("loop", ("a",), "joint", t, signals, ("rad",), controller=law, derived=("velocity",))


def gains(recording: Recording) -> Remark:
    (remark,) = (r for r in inspect([recording]).recordings[0].remarks if r.topic == "gains")
    return remark


@pytest.mark.parametrize("late", [0, 1])
@pytest.mark.parametrize(
    ("way", "named"),
    [("one", "over one sample"), ("two", "over 2 samples"), ("four", "over 4 samples")],
)
def test_differences(way: str, named: str, late: int) -> None:
    remark = gains(looped(way, late))
    assert remark.severity in ("ok", "note")
    first = remark.value["explanations"][0]
    assert named in first and ("of 1 tick earlier" if late else "of the same row") in first
    assert "times the stated" not in first


def test_a_low_pass() -> None:
    remark = gains(looped("low-pass"))
    assert "behind a low-pass of 8 ms" in remark.value["explanations"][0]


def test_gains_that_are_wrong_are_still_told() -> None:
    remark = gains(looped("two", gain=1.4))
    assert remark.value["factors"]["kd_0"]["value"] == pytest.approx(1.4, rel=0.02)
    assert "kd of 'a' 1.4 times the stated one" in remark.text


def test_the_measured_drive(tmp_path: Path) -> None:
    """EMPS: a difference over two samples with the stated gains; a late speed and another gain do as well."""
    remark = gains(load_recording(emps_toml(tmp_path)))
    assert remark.text.startswith(
        "With the speed as a difference of the position over 2 samples, of the same row, the"
    )
    for gain in ("kp_0", "kd_0"):
        assert remark.value["factors"][gain]["value"] == pytest.approx(1.0, abs=3e-4)
    assert (
        "Equally good: a speed that was measured and not logged, of 1 tick earlier, and kd of 'slide' 1.152"
        in remark.text
    )


def test_a_speed_that_was_logged_is_taken_as_it_is() -> None:
    r = looped("two")
    measured = replace(r, derived=())
    assert all("difference of the position" not in m.text for m in inspect([measured]).recordings[0].remarks)
