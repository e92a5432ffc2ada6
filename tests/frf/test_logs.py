"""Recordings as they come from files: a clock that jitters, a controller that the log does not follow."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.core import Controller
from workbench.frf import estimate
from workbench.recordings import load_recording, save_recording

from ..data_helpers import csv_text, write_toml
from .machines import drive_recording
from .make import RATE, design, loop_recordings, truth


@pytest.mark.parametrize("grid", ["full", "odd_random"])
def test_a_clock_that_jitters(grid, tmp_path: Path) -> None:
    """Rows 3 % of a period early or late, resampled when read: a per cent at a twentieth of the rate."""
    d = design(grid=grid, periods=8, f_max_hz=25)
    (made,) = loop_recordings(d, noise=0.0)
    t = made.time + 0.03 / RATE * np.random.default_rng(0).normal(size=len(made))
    # what a log has at its own times: the signals between the rows, band-limited
    columns = {"t": np.round(t, 9)}
    for name, short in (("position", "q"), ("velocity", "w"), ("torque_measured", "u"),
                        ("torque_feedforward", "ff")):  # fmt: skip
        values = made.signals[name][:, 0]
        slope = np.gradient(values, made.period)
        columns[short] = values + slope * (t - made.time)
    (tmp_path / "log.csv").write_text(csv_text(columns))
    excitation = {k: v for k, v in vars(d.excitation(0)).items() if v is not None}
    file = write_toml(
        tmp_path / "log.toml",
        {
            "format": 1,
            "table": "log.csv",
            "axes": ["a"],
            "columns": {
                "time": "t",
                "position": "q",
                "velocity": "w",
                "torque_measured": "u",
                "torque_feedforward": "ff",
            },
            "excitation": excitation,
        },
    )
    recording = load_recording(file)
    assert any("jitter" in n for n in recording.notes)
    frf = estimate([recording])
    assert frf.frequency == pytest.approx(d.frequency, rel=1e-3)
    assert np.abs(frf.response[:, 0, 0] / truth(frf.frequency) - 1).max() < 0.02


def test_a_recording_from_a_file_gives_the_same_response(tmp_path: Path) -> None:
    (made,) = loop_recordings(design(periods=3), noise=0.05, gain=0.4)
    save_recording(made, tmp_path / "made.toml")
    again = estimate([load_recording(tmp_path / "made.toml")])
    assert again.response == pytest.approx(estimate([made]).response, rel=1e-6)


def test_a_controller_faster_than_its_log_leaves_the_hold_open() -> None:
    r = drive_recording()
    assert estimate([r]).hold_s == pytest.approx(1e-3)
    slow = replace(r, controller=Controller("pd", kp=(1.0,), kd=(1.0,), period_s=0.003))
    assert estimate([slow]).hold_s == pytest.approx(1e-3)
    fast = replace(r, controller=Controller("pd", kp=(1.0,), kd=(1.0,), period_s=0.00025))
    frf = estimate([fast])
    assert frf.hold_s is None and any("faster than the log" in n for n in frf.notes)
