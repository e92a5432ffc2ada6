"""Intervals where the model is wrong: they have to cover what its error does to the estimates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.diagnosis.test_folds import made
from workbench.diagnosis.fitting.bounded_least_squares import solve
from workbench.diagnosis.fitting.normal_equations import normal, total
from workbench.diagnosis.fitting.uncertainty import covariance_of

ROWS, PERIOD = 3000, 650


def harmonics(generator: np.random.Generator) -> np.ndarray:
    angle = 2.0 * np.pi * np.arange(ROWS) / PERIOD
    parts = [generator.normal() * np.cos(k * angle + generator.uniform(0.0, 6.3)) for k in range(1, 7)]
    return np.sum(parts, axis=0)


def test_of_a_motion_that_repeats_they_come_from_its_phases() -> None:
    data = replace(made([ROWS], 1), motion_periods=(PERIOD,))
    limits = np.full(3, -np.inf), np.full(3, np.inf)
    generator = np.random.default_rng(0)
    errors, found = [], {"folds": [], "phase_folds": []}
    for _ in range(100):
        response = np.stack([harmonics(generator) for _ in range(3)], axis=-1)[:, None, None, :]
        unexplained = 0.3 * harmonics(generator)[:, None, None]
        for name, deviations in found.items():
            pieces = [normal(response[f.rows], unexplained[f.rows]) for f in getattr(data, name)]
            whole = total(pieces)
            moves = np.array([solve(whole - piece, *limits) for piece in pieces])
            deviations.append(np.diag(covariance_of(whole, np.zeros((3, 3)), moves, 1.0, data)))
        errors.append(solve(normal(response, unexplained), *limits) ** 2)
    true = np.sqrt(np.mean(errors))
    assert 0.5 * true < np.sqrt(np.mean(found["phase_folds"])) < 2.0 * true
    assert np.sqrt(np.mean(found["folds"])) < 0.2 * true, "copies of one period hardly move an estimate"
