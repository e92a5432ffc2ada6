"""Signals that are late, early or filtered are told with how much."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy

from tests.inspection.belt import alarms, later, remarks, times
from workbench.core import Recording


@pytest.mark.parametrize("rows", [1, 4, -2])
def test_velocity_channel_with_another_clock(sound: Recording, rows: int) -> None:
    found = [r for r in alarms(later(sound, "velocity", rows)) if r.topic == "clock" and r.axis]
    assert [r.axis for r in found] == ["a", "b"]
    for remark in found:
        assert remark.value["offset_s"] == pytest.approx(rows * 1e-3, abs=2.5e-4)


def filtered(recording: Recording, time: float) -> Recording:
    """The same with a speed that the drive has passed through a first-order low-pass [s]."""
    share = 1.0 - np.exp(-recording.period / time)
    v = scipy.signal.lfilter([share], [1.0, share - 1.0], recording.velocity, axis=0)
    return replace(recording, signals={**recording.signals, "velocity": v})


@pytest.mark.parametrize("time", [0.02, 0.05])
def test_a_speed_that_the_drive_has_filtered_is_no_gear_ratio(sound: Recording, time: float) -> None:
    found = [r for r in alarms(filtered(sound, time)) if "Velocity of 'a'" in r.text]
    assert [r.topic for r in found] == ["clock"] and "low-pass" in found[0].text
    assert found[0].value["filter_s"] == pytest.approx(time, rel=0.1)
    geared = [
        r for r in alarms(times(filtered(sound, time), "velocity", 0, 0.7)) if "Velocity of 'a'" in r.text
    ]
    assert any("gear ratio" in r.text for r in geared), "a filter and a ratio are no filter"


def test_delay_of_torque_to_a_part_of_a_row(sound: Recording) -> None:
    command = sound.signals["torque_command"]
    between = 0.6 * np.roll(command, 3, axis=0) + 0.4 * np.roll(command, 4, axis=0)
    delays = [r for r in remarks(sound.with_signals(torque_measured=between)) if r.topic == "delay"]
    assert [r.value["delay_s"] for r in delays] == pytest.approx([3.4e-3, 3.4e-3], abs=2e-5)


def test_noise_makes_no_delay(sound: Recording) -> None:
    rng, command = np.random.default_rng(4), sound.signals["torque_command"]
    at_once = {**sound.signals, "torque_measured": command + rng.normal(0, 0.05, command.shape)}
    said = [r.text for r in remarks(replace(sound, signals=at_once)) if r.topic == "delay" and r.axis]
    assert said == [f"Measured torque of '{axis}' comes with its command, in the same row." for axis in "ab"]


def test_torque_before_its_command(sound: Recording) -> None:
    found = alarms(later(sound, "torque_measured", -8))
    assert {r.topic for r in found} >= {"clock"} and "before its command" in " ".join(r.text for r in found)


def test_noise_puts_no_torque_before_its_command(sound: Recording) -> None:
    """Of slow commands under noise the delay is known to half a row; that it is negative means nothing."""
    slowly = scipy.signal.butter(2, 3.0, fs=1 / sound.period, output="sos")
    command = scipy.signal.sosfiltfilt(slowly, sound.signals["torque_command"], axis=0)
    for seed in range(12):
        noise = np.random.default_rng(seed).normal(0, 0.3 * command.std(), command.shape)
        slow = {**sound.signals, "torque_command": command, "torque_measured": command + noise}
        assert "clock" not in {r.topic for r in remarks(replace(sound, signals=slow)) if "torque" in r.text}
