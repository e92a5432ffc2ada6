"""The noise floor is what a perfect model would score, whatever the rates of log and loop and the clock."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.data_helpers import LEG as EXAMPLES
from tests.simulation.make import LEG_LOOP, leg_experiment
from workbench.comparison import compare
from workbench.comparison.consistent import consistent, signal_ratios
from workbench.comparison.noise import rig_noise
from workbench.core import Recording
from workbench.effects import load_model
from workbench.recordings import load_recordings
from workbench.rigs import degrade
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


def test_ticks_that_no_row_shows_do_not_raise_the_floor_of_a_measured_leg() -> None:
    """Rows of 5 ms, ticks of 3 ms: a right model's error and the floor beside it."""
    clean = sorted(map(str, (EXAMPLES / "clean").glob("*.toml")))
    slow = [degrade(log, every=5) for log in load_recordings(clean)]
    result = compare(LEG, slow)
    assert result.consistent and result.noise_error == pytest.approx(result.error, rel=0.16)


def test_motion_that_passes_for_noise_in_half_of_the_recordings_is_not_the_rig_s() -> None:
    calm = measured(LEG, leg_experiment(3.0, 0.001, LEG_LOOP), range(2))
    rough = np.random.default_rng(0).normal(0.0, 0.03, calm[0].velocity.shape)
    shaken = [log.with_signals(velocity=log.velocity + rough) for log in calm]
    np.testing.assert_allclose(rig_noise([*calm, *shaken]).velocity_std, 0.015, rtol=0.1)


def test_a_loop_that_noise_blows_up_explains_nothing() -> None:
    """A floor far above the signal itself would excuse any error."""
    draws = np.full((5, 2, 1), 1e4)
    assert not consistent(np.full((2, 1), 1e3), draws, 30.0, np.array([90.0, 100.0, 110.0, 95.0, 105.0]))
    assert consistent(np.full((2, 1), 1e-3), draws * 1e-7, 0.03, np.array([0.03, 0.031, 0.029, 0.03, 0.03]))


def test_the_worst_of_many_signals_is_no_finding() -> None:
    """Noise alone, of few independent samples: as seldom beyond its limit on forty axes as on one."""
    rng, tries, freedom = np.random.default_rng(0), 400, 10
    beyond = {}
    for axes in (1, 40):
        draws = rng.chisquare(freedom, (tries, 4, 2, axes)) / freedom
        errors = rng.chisquare(freedom, (tries, 2, axes)) / freedom
        found = [signal_ratios(e, d) for e, d in zip(errors, draws, strict=True)]
        beyond[axes] = np.mean([(ratios > limits).any() for ratios, limits in found])
    assert beyond[40] < 0.1 and beyond[40] < 3.0 * beyond[1]


def test_one_signal_off_is_named_with_what_noise_makes_of_it() -> None:
    logs = measured(LEG, leg_experiment(3.0, 0.001, LEG_LOOP), range(2))
    right = compare(LEG, logs)
    assert right.consistent and right.outlier is None
    wrong = np.array([0.0, 3e-3]) * np.sin(2 * np.pi * 40.0 * logs[0].time)[:, None]
    off = compare(LEG, [log.with_signals(position=log.position + wrong) for log in logs])
    assert not off.consistent and off.outlier is not None
    assert (off.outlier.axis, off.outlier.signal) == (LEG.axes[1], "position")
    pooled = np.mean([e.position_rmse[1] ** 2 for e in off.recordings]) ** 0.5
    noise = np.mean([e.position_noise[1] ** 2 for e in off.recordings]) ** 0.5
    assert off.outlier.limit < off.outlier.ratio == pytest.approx(pooled / noise, rel=0.1)


def test_what_a_loop_reads_of_late_rows_counts_as_noise() -> None:
    """Rows of 0.15 ms off their times read a fast axis wrongly, and the controller answers that."""
    asked = leg_experiment(4.0, 0.001, LEG_LOOP)
    prompt = measured(LEG, asked, range(2))
    late = [replace(log, late_s=1.5e-4) for log in prompt]
    noise = [compare(LEG, logs).recordings[0].torque_noise for logs in (prompt, late)]
    kp, rate = 50.0, prompt[0].velocity.std(axis=0)
    answered = kp * 1.5e-4 * rate @ np.abs(np.linalg.inv(LEG.transmission))
    assert (np.sqrt(noise[1] ** 2 - noise[0] ** 2) > 0.5 * answered).all()
