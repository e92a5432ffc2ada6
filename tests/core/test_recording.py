"""A recording is a value: it cannot be changed, only replaced."""

import numpy as np
import pytest

from workbench.core import Recording


@pytest.fixture
def recording() -> Recording:
    t = np.arange(5) * 0.01
    signals = {"position": np.zeros((5, 2)), "velocity": np.ones((5, 2))}
    return Recording("made", ("a", "b"), "actuator", t, signals, ("rad", "m"))


def test_length_period_and_duration(recording: Recording) -> None:
    assert len(recording) == 5
    assert recording.period == pytest.approx(0.01)
    assert recording.duration == pytest.approx(0.04)
    assert recording.valid.all()
    assert recording.get("torque_measured") is None


def test_nothing_in_it_can_be_changed(recording: Recording) -> None:
    for array in (recording.time, recording.position, recording.valid):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    with pytest.raises(TypeError):
        recording.signals["position"] = np.ones((5, 2))  # type: ignore[index]


def test_the_callers_arrays_stay_writable() -> None:
    own = np.zeros((5, 1))
    Recording("made", ("a",), "actuator", np.arange(5) * 0.1, {"position": own}, ("rad",))
    assert own.flags.writeable
    own[0] = 1.0
    assert own[0, 0] == 1.0


def test_a_copy_with_other_signals_leaves_the_first_alone(recording: Recording) -> None:
    other = recording.with_signals(position=np.ones((5, 2)))
    assert other.position.all()
    assert not recording.position.any()
    np.testing.assert_array_equal(other.velocity, recording.velocity)


def test_some_rows_are_a_recording_whose_time_begins_anew(recording: Recording) -> None:
    part = recording.with_signals(velocity=np.arange(10.0).reshape(5, 2)).rows(slice(2, 5))
    assert len(part) == len(part.valid) == 3
    assert part.time == pytest.approx([0.0, 0.01, 0.02])
    assert (part.velocity == [[4.0, 5.0], [6.0, 7.0], [8.0, 9.0]]).all()
    assert part.axes == recording.axes
