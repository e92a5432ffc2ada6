"""Where a run begins: at rest at the first reference, or where the first rows were."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core import Controller, Recording
from workbench.simulation.initial_state import initial_state

LOOP = Controller("pd", "joint", kp=(35.0,), kd=(1.2,), period_s=0.001)
STEP = 2 * np.pi / 2**15


def started(sag: float, period: float) -> np.ndarray:
    """The state (2,) in which the run of a log begins, of an axis that weight holds off its reference."""
    t = np.arange(round(6.0 / period)) * period
    reference = 0.3 + 0.4 * np.sin(2 * np.pi * 1.3 * t)
    follows = 0.3 + 0.4 * np.sin(2 * np.pi * 1.3 * np.maximum(t - 0.03, 0.0)) + sag
    position = np.round(follows / STEP) * STEP
    signals = {"position": position[:, None], "position_reference": reference[:, None]}
    recording = Recording("log", ("tilt",), "joint", t, signals, ("rad",), controller=LOOP)
    one = np.eye(1)
    return initial_state(recording, LOOP, reference[:, None], one, one)[:, 0]


@pytest.mark.parametrize("period", [0.02, 0.01, 0.005])
def test_positions_alone_in_few_rows_say_where_a_run_began(period: float) -> None:
    """A sag of 14 mrad, taken for none, was half a second of error in a model without fault."""
    position, _ = started(0.0143, period)
    assert position == pytest.approx(0.3143, abs=2 * STEP)


def test_what_rounding_makes_is_no_other_start() -> None:
    assert started(0.4 * STEP, 0.02) == pytest.approx([0.3, 0.0], abs=1e-12)
