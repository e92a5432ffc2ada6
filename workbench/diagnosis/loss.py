"""Losses of a fit on fitted data and on other data, their noise floors, and the share explained."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .data import Data
from .hypothesis import Fit
from .policy import POLICY


def test_noise_floor(data: Data) -> float:
    """Return the test loss of a perfect model: from noise, and from the divergence of correct simulations."""
    return data.objective(data.least(held_out=data.tests_on_holdout))


def training_noise_floor(data: Data) -> float:
    """Return the training loss of a perfect model."""
    return data.objective(data.least())


def rescored(old: Fit, data: Data) -> Fit:
    """The same fit with losses under the weights of `data`; parameters are unchanged, also those of folds."""
    training_loss = data.objective(data.pool(old.mean_squares))
    if data.tests_on_holdout:
        folds = np.array([data.objective(ms) for ms in old.mean_squares[data.training :]])
        test_loss = data.objective(data.pool(old.mean_squares, held_out=True))
    else:
        folds = np.array(
            [
                np.mean(
                    np.sum(
                        (data.residual(f.recording, old.simulated[f.recording])[f.rows] * data.weight) ** 2,
                        (1, 2),
                    )
                )
                for f in data.folds
            ]
        )
        test_loss = training_loss
    return replace(old, training_loss=training_loss, test_loss=test_loss, fold_losses=folds)


def explained(data: Data, start: Fit, end: Fit, at_end: Data) -> float:
    """Return the share of the initial excess over a perfect model that is gone at the end, of fitted or
    held-out data, the smaller.

    `at_end` has the floor of the last model, whose runs noise may drive farther apart than the first's.
    """
    shares = []
    for held_out in {False, data.tests_on_holdout}:
        floor = data.least(held_out)
        first, last = data.pool(start.mean_squares, held_out), data.pool(end.mean_squares, held_out)
        before = data.objective(np.maximum(first - floor, 0.0))
        rest = np.maximum(floor, at_end.least(held_out))
        after = data.objective(np.maximum(last - POLICY.noise_slack * rest, 0.0))
        shares.append(float(np.clip(1.0 - after / before, 0.0, 1.0)) if before > 0 else 0.0)
    return min(shares)


def median_explained(data: Data, start: Fit, end: Fit, at_end: Data) -> float:
    """Return the same as `explained`, but the length-weighted median over recordings, for trajectories that
    diverge.

    Near a gap's resonance two motions are possible; no model predicts which of them a recording shows.
    """
    worst = 1.0
    for part in (slice(0, data.training), slice(data.training, None))[: 1 + data.tests_on_holdout]:
        weight = data.weight**2
        floor, other = (d.floor[part] + d.immaterial[part] for d in (data, at_end))
        rest = np.maximum(floor, other)
        before = np.sum(np.maximum(start.mean_squares[part] - floor, 0.0) * weight, axis=(1, 2))
        last = np.maximum(end.mean_squares[part] - POLICY.noise_slack * rest, 0.0)
        after = np.sum(last * weight, axis=(1, 2))
        shares = 1.0 - after / np.maximum(before, 1e-12)
        rows = np.array([int(np.sum(r.valid)) for r in data.recordings[part]])
        order = np.argsort(shares)
        middle = np.searchsorted(np.cumsum(rows[order]), 0.5 * rows.sum())
        worst = min(worst, float(np.clip(shares[order][middle], 0.0, 1.0)))
    return worst
