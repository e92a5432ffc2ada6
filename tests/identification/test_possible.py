"""Least squares whose bodies can exist: the plain solution where it can, otherwise the nearest that does."""

import numpy as np
import pytest

from workbench.diagnosis import Normal
from workbench.identification.possible import fit_possible, nearest_possible
from workbench.identification.rigid_body import DIRECTIONS


def body(steps: np.ndarray) -> np.ndarray:
    """The pseudo-inertia of a link after some steps from a body of its own size."""
    return np.eye(4) + np.tensordot(steps, DIRECTIONS, 1)


def problem(seed: int, aim: np.ndarray, rows: int = 200, noise: float = 0.0) -> Normal:
    """Rows that ask for some unknowns (C,)."""
    generator = np.random.default_rng(seed)
    x = generator.normal(size=(rows, len(aim)))
    y = x @ aim + noise * generator.normal(size=rows)
    return Normal(x.T @ x, x.T @ y, float(y @ y), rows)


def test_inside_it_is_the_plain_solution():
    aim = np.concatenate([[3.0, -5.0], 0.05 * np.arange(10) / 10])
    asked = problem(0, aim)
    np.testing.assert_allclose(nearest_possible(asked.gram, asked.right, [np.eye(4)]), aim, atol=1e-9)


def test_outside_it_is_the_best_body_that_can_exist():
    """Compared with many other bodies that can exist, none of which fits better."""
    asked = problem(1, np.concatenate([[2.0], -0.9 * np.ones(10)]))
    found = nearest_possible(asked.gram, asked.right, [np.eye(4)])
    assert np.linalg.eigvalsh(body(found[1:]))[0] == pytest.approx(0.05, abs=1e-6)
    generator, left = np.random.default_rng(2), asked.after(found)
    for _ in range(500):
        root = generator.normal(size=(4, 4))
        other = root @ root.T * generator.uniform(0.01, 1.0) + 0.05 * np.eye(4)
        steps = np.tensordot(DIRECTIONS, other - np.eye(4), 2)
        blend = found + generator.uniform(1e-4, 1.0) * (np.concatenate([[2.0], steps]) - found)
        assert asked.after(blend) >= left - 1e-6 * abs(left)


def test_two_links_do_not_disturb_each_other():
    aim = np.concatenate([-np.ones(10), 0.02 * np.ones(10)])
    asked = Normal(np.eye(20), aim, float(aim @ aim), 20)
    found = nearest_possible(asked.gram, asked.right, [np.eye(4), np.eye(4)])
    np.testing.assert_allclose(found[10:], aim[10:], atol=1e-6)
    assert np.linalg.eigvalsh(body(found[:10]))[0] == pytest.approx(0.05, abs=1e-6)


def test_what_the_data_give_is_not_held_by_the_file():
    """Clear data: the trust in the file falls until the truth comes out."""
    aim = np.concatenate([[1.0], 0.1 * np.cos(np.arange(10))])
    blocks = [problem(seed, aim, noise=0.01) for seed in range(5)]
    found = fit_possible(blocks, np.array([0.0, *np.ones(10)]), [np.eye(4)])
    np.testing.assert_allclose(found.whole, aim, atol=0.003)
    assert found.identifiable(1) == pytest.approx(10.0, abs=0.02)


def test_where_the_data_are_noise_the_file_stays():
    """Next to nothing but noise, and more unknowns than it tells: the file predicts best."""
    blocks = [problem(seed, np.zeros(11), rows=2, noise=1.0) for seed in range(4)]
    found = fit_possible(blocks, np.array([0.0, *np.ones(10)]), [np.eye(4)])
    assert np.abs(found.whole[1:]).max() < 0.2
    assert found.identifiable(1) < 8.0  # of ten, from eight rows
