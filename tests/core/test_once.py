"""What follows from a recording alone is computed once for each, and forgotten with it."""

from __future__ import annotations

import gc

import numpy as np

from workbench.core import Recording
from workbench.core.once import once_per_recording
from workbench.recordings.noise import position_levels


def recording(seed: int = 0) -> Recording:
    position = np.cumsum(np.random.default_rng(seed).standard_normal((200, 1)), axis=0)
    return Recording("made", ("a",), "joint", 0.01 * np.arange(200), {"position": position}, ("rad",))


def test_each_recording_is_asked_once() -> None:
    asked: list[float] = []

    @once_per_recording
    def last(each: Recording) -> float:
        asked.append(float(each.position[-1, 0]))
        return asked[-1]

    one, other = recording(0), recording(1)
    assert [last(r) for r in (one, other, one, other)] == [*asked, *asked] and len(asked) == 2
    assert last(one.rows(slice(0, 50))) == one.position[49, 0]
    del other
    gc.collect()
    # new ones may lie where one was that is gone
    assert all(last(r) == r.position[-1, 0] for r in map(recording, range(2, 50)))


def test_noise_of_positions_is_kept_with_its_recording() -> None:
    one = recording()
    assert position_levels(one) is position_levels(one)
    assert position_levels(recording()) is not position_levels(one)
