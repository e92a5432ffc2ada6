"""Training data in pieces: every row in one, none so long that what only it shows cannot be judged."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from workbench.core import Recording
from workbench.diagnosis.data import Data


def made(lengths: list[int], training: int) -> Data:
    recordings = tuple(
        Recording(f"r{k}", ("a",), "actuator", 0.01 * np.arange(n), {"position": np.zeros((n, 1))}, ("rad",))
        for k, n in enumerate(lengths)
    )
    none = np.zeros((len(lengths), 2, 1))
    return Data(recordings, training, None, none, none, (), np.ones((2, 1)))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("lengths", "pieces"),
    [
        ([100], [5]),
        ([60, 60, 60, 60, 60], [1, 1, 1, 1, 1]),
        ([600, 100, 100, 100, 100], [3, 1, 1, 1, 1]),
        ([50, 50], [2, 2]),
        ([500, 3], [5, 1]),
    ],
)
def test_long_recordings_are_judged_in_pieces(lengths: list[int], pieces: list[int]) -> None:
    data = made([*lengths, 70], len(lengths))  # the last is held out
    assert [sum(f.recording == k for f in data.folds) for k in range(len(lengths))] == pieces
    for k, n in enumerate(lengths):
        rows = np.concatenate([np.arange(n)[f.rows] for f in data.folds if f.recording == k])
        np.testing.assert_array_equal(rows, np.arange(n))


def test_pieces_of_a_motion_that_repeats_are_no_copies() -> None:
    data = replace(made([100, 90], 2), motion_periods=(20, None))
    pieces = [f for f in data.phase_folds if f.recording == 0]
    phases = [set(np.arange(100)[f.rows] % 20) for f in pieces]
    assert len(pieces) == 3 and not set.intersection(*phases)
    assert sorted(np.concatenate([np.arange(100)[f.rows] for f in pieces])) == list(range(100))
    assert [f for f in data.phase_folds if f.recording == 1] == [f for f in data.folds if f.recording == 1]


def test_repeats_belong_to_the_recordings_that_are_chosen() -> None:
    replay: Any = SimpleNamespace(only=lambda chosen: None)
    data = replace(made([100, 90, 80], 3), motion_periods=(20, None, 30), replay=replay)
    assert data.part([2, 1]).motion_periods == (30, None)
