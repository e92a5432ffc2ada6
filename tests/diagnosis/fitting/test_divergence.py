"""How far runs come to lie from each other that nearly the same machine makes."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from workbench.core import EffectKey, Estimate
from workbench.diagnosis.data import Data
from workbench.diagnosis.fitting.divergence import divergence
from workbench.diagnosis.hypothesis import Fit, Hypothesis
from workbench.effects import load_model
from workbench.models import AppliedEffect

LEG = load_model("leg")
VALUES = {"gap": Estimate(0.004, 0.0003, "rad"), "stiffness": Estimate(400.0, 20.0, "N*m/rad")}
GAP = AppliedEffect(EffectKey("backlash", "knee"), VALUES)
ROWS = np.zeros((100, 2, 2))


def parted(*ways: float) -> np.ndarray:
    """Of a fit's own run and four others, each off by so much at every row."""
    found = SimpleNamespace(
        hypothesis=Hypothesis(LEG, (GAP,)), simulated=(ROWS,), mean_squares=np.zeros((1, 2, 2))
    )

    def run(models: list[Any]) -> list[tuple[np.ndarray]]:
        assert len(models) == len(ways) == 4, "either end of two intervals"
        return [(ROWS + node,) for node in ways]

    data = SimpleNamespace(run=run, residual=lambda index, rows: rows)
    return divergence(cast(Fit, found), cast(Data, data))


def test_it_is_what_pairs_of_runs_typically_differ_by() -> None:
    assert parted(0.1, -0.1, 0.1, -0.1) == pytest.approx(0.01 * np.ones((1, 2, 2)))


def test_one_end_on_another_motion_says_nothing_of_the_middle() -> None:
    assert parted(0.1, -0.1, 0.1, 50.0)[0, 0, 0] < 0.1


def test_what_does_not_run_is_left_out() -> None:
    assert np.isfinite(parted(0.1, -0.1, 0.1, np.nan)).all()
    assert (parted(np.nan, np.nan, np.nan, np.nan) == 0.0).all()
