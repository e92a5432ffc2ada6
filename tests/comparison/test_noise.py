"""The noise floor is what a perfect model would score, whatever the rates of log and loop and the clock."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from exam.degrade import degrade

from tests.data_helpers import LEG as EXAMPLES
from tests.simulation.make import LEG_LOOP, leg_experiment
from workbench.comparison import Scale, compare
from workbench.comparison.consistent import consistent
from workbench.comparison.noise import rig_noise
from workbench.core import Recording
from workbench.effects import load_model
from workbench.recordings import load_recordings
from workbench.simulation import Run, simulate

from .make import measured

LEG = load_model("leg")


def score(logs: list[Recording], clean: Recording) -> float:
    """Root mean square over axes and signals of RMSE over deviation, by the definition, pooled."""
    parts = []
    for name in ("position", "torque_measured"):
        difference = np.concatenate([log.signals[name] - clean.signals[name] for log in logs])
        deviation = np.concatenate([log.signals[name] for log in logs]).std(axis=0)
        parts.append(np.mean(difference**2, axis=0) / deviation**2)
    return float(np.sqrt(np.mean(parts)))


#: Row period and the loop's own period [s].
RATES = [
    (0.001, 0.003),
    (0.002, 0.003),
    (0.005, 0.003),
    (0.005, 0.010),
    (0.005, 0.005),
    (0.003, 0.003),
]


@pytest.mark.parametrize(("period", "tick"), RATES)
def test_the_noise_error_is_what_many_noisy_runs_give(period: float, tick: float) -> None:
    asked = leg_experiment(3.0 if period == 0.001 else 6.0, period, replace(LEG_LOOP, period_s=tick))
    (clean,) = simulate([Run(LEG, asked)])
    many = measured(LEG, asked, range(8))
    result = compare(LEG, many[:1], draws=6)
    assert result.noise_error == pytest.approx(score(many, clean), rel=0.05 if period == 0.001 else 0.2)
    assert result.error == pytest.approx(score(many[:1], clean), rel=1e-6)


@pytest.mark.parametrize("every", [2, 4, 5])
def test_rows_that_miss_ticks_of_the_loop_are_no_error(every: int) -> None:
    asked = leg_experiment(4.0, 0.001, LEG_LOOP)
    thinned = [degrade(log, every=every) for log in measured(LEG, asked, range(2))]
    result, whole = compare(LEG, thinned), compare(LEG, measured(LEG, asked, range(2)))
    assert result.consistent and result.error == pytest.approx(whole.error, rel=0.1)


def test_ticks_that_no_row_shows_do_not_raise_the_floor() -> None:
    """Rows of 5 ms, ticks of 3 ms: a right model's error and the floor beside it."""
    clean = sorted(map(str, (EXAMPLES / "clean").glob("*.toml")))
    slow = [degrade(log, every=5) for log in load_recordings(clean)]
    result = compare(LEG, slow)
    assert result.consistent and result.noise_error == pytest.approx(result.error, rel=0.16)


def test_motion_that_passes_for_noise_is_not_the_rig_s() -> None:
    calm = measured(LEG, leg_experiment(3.0, 0.001, LEG_LOOP), range(2))
    rough = np.random.default_rng(0).normal(0.0, 0.03, calm[0].velocity.shape)
    shaken = [log.with_signals(velocity=log.velocity + rough) for log in calm]
    np.testing.assert_allclose(rig_noise([*calm, *shaken]).velocity_std, 0.015, rtol=0.1)


def test_a_loop_that_noise_blows_up_explains_nothing() -> None:
    """A floor far above the signal itself would excuse any error."""
    scale = Scale(np.ones(1), np.ones(1))
    draws = 1e4 * np.array([0.81, 1.0, 1.21, 0.9, 1.1])[:, None, None] * np.ones((5, 2, 1))
    assert not consistent(np.full((2, 1), 1e3), draws, scale)
    assert consistent(np.full((2, 1), 1e-3), draws * 1e-7, scale)


def test_what_two_right_simulations_differ_by_is_no_error() -> None:
    scale = Scale(np.ones(1), np.ones(1))
    draws = 1e-10 * np.array([0.98, 1.0, 1.02, 0.99, 1.01])[:, None, None] * np.ones((5, 2, 1))
    assert not consistent(np.full((2, 1), 1.3e-10), draws, scale)
    assert consistent(np.full((2, 1), 1.3e-10), draws, scale, np.full((2, 1), 4e-11))
