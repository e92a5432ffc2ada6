"""A motion that repeats itself is seen to, and after how many rows."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core import Recording
from workbench.diagnosis.motion_period import motion_period

T = 0.005 * np.arange(4000)
NOISE = 1e-3 * np.random.default_rng(0).standard_normal((len(T), 2))


def moved(*axes: np.ndarray) -> Recording:
    position = np.column_stack(axes)
    names = tuple("abc"[: len(axes)])
    return Recording("r", names, "actuator", T, {"position": position}, ("rad",) * len(axes))


def periodic(period: float) -> tuple[np.ndarray, np.ndarray]:
    """Two sums of harmonics, with the noise of an encoder."""
    w = 2.0 * np.pi / period * T
    first = np.sin(w) + 0.6 * np.sin(3.0 * w + 1.0)
    return 0.3 * first + NOISE[:, 0], 0.2 * np.cos(2.0 * w) + 0.1 * np.sin(5.0 * w) + NOISE[:, 1]


@pytest.mark.parametrize("period", [0.5, 5.5, 9.9])
def test_the_period_of_all_axes_together_is_found(period: float) -> None:
    assert motion_period(moved(*periodic(period))) == pytest.approx(period / 0.005, abs=2)


def test_an_axis_that_is_held_says_nothing() -> None:
    assert motion_period(moved(*periodic(5.5), NOISE[:, 0])) == pytest.approx(1100, abs=2)


@pytest.mark.parametrize(
    "motion",
    [
        (np.sin(0.5 * T * T),),  # a chirp
        (periodic(11.0)),  # not twice in the recording
        (np.sin(2.0 * T), np.sin(2.0 * np.sqrt(3.0) * T)),  # never together again
        (np.cumsum(NOISE[:, 0]),),
        (NOISE[:, 0],),
        (np.zeros(len(T)),),
        (T,),
    ],
)
def test_what_does_not_repeat_has_no_period(motion: tuple[np.ndarray, ...]) -> None:
    assert motion_period(moved(*motion)) is None
