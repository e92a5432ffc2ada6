"""Columns of effects along the measured motion, and what a torque that is logged late takes of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.core import Recording
from workbench.diagnosis.data import gather_along
from workbench.diagnosis.problem import starting_fit
from workbench.diagnosis.screening.stepwise_regression import selected
from workbench.diagnosis.screening.torque_columns import regression_of
from workbench.diagnosis.screening.torque_regression import Regression
from workbench.effects import load_model


def regression(folder: Path, late: int = 0, **numbers: float) -> Regression:
    """Of a machine with other numbers than its model, whose torque is logged so many rows late."""
    machine, model = bench_arm(folder, "machine", **numbers), load_model(bench_arm(folder))
    logs = [logged(machine, tones, seconds=5.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    data, runs = gather_along(model, [delayed(log, late) for log in logs], len(logs), seed=0)
    return regression_of(starting_fit(model, data, runs.clean), data)


def delayed(log: Recording, rows: int) -> Recording:
    torque = np.roll(log.signals["torque_measured"], rows, axis=0)
    return log.with_signals(torque_measured=torque)


@pytest.mark.parametrize("mass", [0.8, 1.9])
def test_a_mass_that_is_far_off_leaves_only_noise(tmp_path: Path, mass: float) -> None:
    """What is lacking looks like a torque that is many rows late; taking that off makes no friction."""
    asked = regression(tmp_path, fore_mass=mass)
    found = selected(asked)
    assert [str(e.key) for e in found.chosen] == ["first_moment_error@bend"]
    np.testing.assert_allclose(found.solution.coefficients, mass - 1.3, rtol=0.01)
    assert np.all(found.solution.validated < asked.floor)


def test_a_torque_that_is_many_rows_late_stays_late(tmp_path: Path) -> None:
    asked = regression(tmp_path, late=5, fore_mass=0.8)
    assert np.all(selected(asked).solution.validated > 2.0 * asked.floor)
