"""Blocks that are left out in turn judge the weight of a penalty."""

from __future__ import annotations

import numpy as np

from workbench.diagnosis.fitting.left_out import left_out
from workbench.diagnosis.fitting.normal_equations import normal

BLOCKS, ROWS = 5, 40


def test_what_is_left_is_that_of_fits_without_each_block() -> None:
    random = np.random.default_rng(0)
    columns, torque = random.normal(size=(BLOCKS, ROWS, 3)), random.normal(size=(BLOCKS, ROWS))
    blocks = [normal(x, y) for x, y in zip(columns, torque, strict=True)]
    found = left_out(blocks, np.eye(3), np.zeros(1))
    left = 0.0
    for k in range(BLOCKS):
        others = [b for b in range(BLOCKS) if b != k]
        fitted = np.linalg.lstsq(np.concatenate(columns[others]), np.concatenate(torque[others]))[0]
        np.testing.assert_allclose(found.each[k], fitted, rtol=1e-9)
        left += np.sum((torque[k] - columns[k] @ fitted) ** 2)
    np.testing.assert_allclose(found.left, left, rtol=1e-9)


def test_noise_takes_the_heaviest_penalty_a_law_the_lightest() -> None:
    random = np.random.default_rng(1)
    columns = random.normal(size=(BLOCKS, ROWS, 8))
    noise = random.normal(size=(BLOCKS, ROWS))
    weights = np.array([1e-3, 1e6])
    nothing = left_out([normal(x, y) for x, y in zip(columns, noise, strict=True)], np.eye(8), weights)
    law = left_out(
        [normal(x, x.sum(axis=1) + 0.1 * y) for x, y in zip(columns, noise, strict=True)], np.eye(8), weights
    )
    assert np.abs(nothing.whole).max() < 1e-3
    np.testing.assert_allclose(law.whole, 1.0, atol=0.05)
