"""Bounded least squares from normal equations."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from workbench.diagnosis.fitting.bounded_least_squares import solve
from workbench.diagnosis.fitting.normal_equations import Normal, normal


@given(st.integers(0, 10_000), st.integers(1, 5), st.booleans())
def test_agrees_with_least_squares_on_the_rows(seed: int, unknowns: int, bounded: bool) -> None:
    random = np.random.default_rng(seed)
    response = random.standard_normal((30, 2, 1, unknowns)) * 10.0 ** random.uniform(-4, 4, unknowns)
    residual = random.standard_normal((30, 2, 1))
    low = np.full(unknowns, -np.inf)
    high = np.full(unknowns, np.inf)
    if bounded:
        low[0] = 0.0
    equations = normal(response, residual)
    rows, target = response.reshape(-1, unknowns), residual.ravel()
    expected = lsq_linear(rows, target, (low, high)).x
    found = solve(equations, low, high)
    left = np.sum((target - rows @ found) ** 2)
    assert np.all(found >= low)
    assert left <= np.sum((target - rows @ expected) ** 2) * (1 + 1e-6)
    assert np.isclose(equations.after(found), left)


def test_what_the_data_do_not_see_stays_where_it_is() -> None:
    random = np.random.default_rng(1)
    seen = random.standard_normal((40, 2, 1, 1))
    response = np.concatenate([seen, seen, np.zeros_like(seen)], axis=-1)
    equations = normal(response, 3.0 * seen[..., 0])
    free = np.full(3, np.inf)
    found = solve(equations, -free, free)
    assert np.isclose(found[0] + found[1], 3.0)
    assert np.allclose(found[:2], 1.5, atol=1e-3)
    assert found[2] == 0.0


def test_an_effect_without_unknowns_needs_no_solution() -> None:
    equations = normal(np.zeros((10, 2, 1, 0)), np.ones((10, 2, 1)))
    assert solve(equations, np.zeros(0), np.zeros(0)).shape == (0,)
    assert equations.square == 20.0


def test_what_may_not_move_stays_however_large_it_is() -> None:
    random = np.random.default_rng(2)
    response = random.standard_normal((30, 2, 1, 2))
    equations = normal(response, response @ [1.0, 2.0])
    found = solve(equations, np.array([-np.inf, -4e4]), np.array([np.inf, -4e4]))
    assert np.isclose(found[1], -4e4)


def test_what_rounding_took_below_nothing_is_solved_too() -> None:
    """Normal equations of all rows less those of most of them are what two large numbers leave."""
    gram = np.array([[1.0, 1.001], [1.001, 1.0]])
    assert np.linalg.eigvalsh(gram)[0] < 0.0
    free = np.full(2, np.inf)
    found = solve(Normal(gram, np.array([2.0, 2.0]), 4.0, 10), -free, free)
    np.testing.assert_allclose(found, 1.0, rtol=0.01)


@given(st.integers(0, 10_000), st.integers(2, 6))
def test_unknowns_at_both_ends_of_their_bounds(seed: int, unknowns: int) -> None:
    """Those that leave their bounds without any are not always those that lie at them in the end."""
    random = np.random.default_rng(seed)
    rows = random.standard_normal((12, unknowns)) @ random.standard_normal((unknowns, unknowns))
    target = random.standard_normal(12)
    low, high = -random.uniform(0.0, 0.3, unknowns), random.uniform(0.0, 0.3, unknowns)
    equations = normal(rows.reshape(12, 1, 1, unknowns), target.reshape(12, 1, 1))
    found = solve(equations, low, high)
    expected = lsq_linear(rows, target, (low, high), method="bvls", tol=1e-14).x
    assert np.all((found >= low - 1e-12) & (found <= high + 1e-12))
    assert equations.after(found) <= equations.after(expected) * (1 + 1e-5)
