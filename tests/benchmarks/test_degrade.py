"""A degraded log lacks what it should and keeps the rest; the reader copes with it."""

from pathlib import Path

import numpy as np
import pytest
from exam.degrade import degrade

from workbench.core import InputError, Recording
from workbench.recordings import load_recording, save_recording
from workbench.rigs import VirtualLeg, chirp


@pytest.fixture(scope="module")
def good() -> Recording:
    return VirtualLeg(seed=1).run([chirp("knee", duration=1.0, f_max=5.0)])[0]


def again(recording: Recording, folder: Path) -> Recording:
    """Written and read back."""
    save_recording(recording, folder / "log.toml")
    return load_recording(folder / "log.toml")


def test_nothing_asked_nothing_lost(good: Recording) -> None:
    same = degrade(good)
    assert (same.name, same.controller) == (good.name, good.controller)
    assert list(same.signals) == list(good.signals)
    for name, rows in good.signals.items():
        np.testing.assert_array_equal(same.signals[name], rows)


def test_signals_are_left_out(good: Recording, tmp_path: Path) -> None:
    poor = degrade(good, without=("velocity", "torque_measured"))
    assert set(good.signals) - set(poor.signals) == {"velocity", "torque_measured"}
    read = again(poor, tmp_path)
    assert read.derived == ("velocity",) and read.get("torque_measured") is None


def test_a_clock_that_jitters_is_read_back_on_a_uniform_one(good: Recording, tmp_path: Path) -> None:
    poor = degrade(good, jitter=0.1, seed=3)
    steps = np.diff(poor.time)
    assert steps.min() > 0 and np.std(steps) == pytest.approx(0.1e-3 * np.sqrt(2), rel=0.1)
    read = again(poor, tmp_path)
    assert any("jitter" in note for note in read.notes)
    assert np.ptp(np.diff(read.time)) < 1e-12 and read.period == pytest.approx(1e-3, rel=2e-3)
    for shown, true in zip(read.position.T, good.position.T, strict=True):
        np.testing.assert_allclose(shown, np.interp(read.time, good.time, true), atol=5e-4)
    np.testing.assert_array_equal(degrade(good, jitter=0.1, seed=3).time, poor.time)
    assert np.abs(degrade(good, jitter=0.1, seed=4).time - poor.time).max() > 0


def test_held_signals_keep_their_levels_under_jitter(good: Recording) -> None:
    command = degrade(good, jitter=0.2).signals["torque_command"]
    assert set(command[:, 0]) <= set(good.signals["torque_command"][:, 0])


def test_rows_are_left_out(good: Recording) -> None:
    poor = degrade(good, every=2)
    assert len(poor) == len(good) // 2 and poor.period == pytest.approx(2e-3)
    np.testing.assert_array_equal(poor.signals["torque_command"], good.signals["torque_command"][::2])


def test_what_cannot_be_left_out_is_refused(good: Recording) -> None:
    with pytest.raises(InputError, match="has no signal 'temperature'"):
        degrade(good, without=("temperature",))
    with pytest.raises(InputError, match="has to have a position"):
        degrade(good, without=("position",))
