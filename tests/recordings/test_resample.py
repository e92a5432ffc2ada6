"""Which signals of a loop wait for its ticks, and which move smoothly and rest now and then."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.recordings.resample import looks_held

T = 0.01 * np.arange(1000)
WAVE = np.sin(1.3 * T)


def resting(share: float) -> np.ndarray:
    """A move every two seconds that takes what is left of them, and rests for a share of them."""
    begun, moved = np.floor(T / 2.0), np.minimum(1.0, T % 2.0 / (2.0 * (1.0 - share)))
    return begun + 0.5 - 0.5 * np.cos(np.pi * moved)


@pytest.mark.parametrize("rows", [2, 5, 20])
def test_a_signal_that_waits_for_ticks_is_held(rows: int) -> None:
    assert looks_held(WAVE[(np.arange(1000) // rows) * rows, None])


def test_ticks_a_little_slower_than_rows_are_held() -> None:
    assert looks_held(WAVE[np.floor(np.floor(np.arange(1000) / 1.6) * 1.6).astype(int), None])


@pytest.mark.parametrize("share", [0.0, 0.4, 0.7])
def test_a_signal_that_rests_between_motions_is_not_held(share: float) -> None:
    assert not looks_held(resting(share)[:, None])


def test_a_held_signal_that_also_rests_is_held() -> None:
    assert looks_held(resting(0.5)[(np.arange(1000) // 5) * 5, None])


def test_steps_are_held() -> None:
    assert looks_held(np.where(T < 4.0, 0.0, 1.0)[:, None])
    assert looks_held(np.repeat([0.0, 1.0, 0.0, 1.0], 250)[:, None])


def test_every_axis_that_moves_has_to_wait() -> None:
    held, still = WAVE[(np.arange(1000) // 5) * 5], np.zeros(1000)
    assert looks_held(np.stack([held, still], axis=1))
    assert not looks_held(np.stack([held, WAVE], axis=1))
    assert not looks_held(still[:, None])
