"""Training data in pieces: every row in one, none so long that what only it shows cannot be judged."""

from __future__ import annotations

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
