"""Springs at once: each by itself as one, and none takes the softness of another."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from workbench.effects.flexible import free_wind, spring_wind
from workbench.effects.springs import _winds

_STEP = 0.001
_T = np.arange(2000) * _STEP
_LOAD = np.stack([np.sin(2 * np.pi * 7.0 * _T), np.cos(2 * np.pi * 11.0 * _T + 0.3) - np.cos(0.3)], axis=1)


def test_one_spring_winds_as_it_does_by_itself() -> None:
    alone = spring_wind(_LOAD[:, 0], _STEP, 0.05, 200.0, 0.4)
    winds = _winds(_LOAD[:, :1], _STEP, np.array([[0.05]]), np.array([200.0]), np.array([0.4]))
    np.testing.assert_allclose(winds[:, 0], alone, rtol=1e-6, atol=1e-6 * np.abs(alone).max())


@pytest.mark.parametrize("damping", [0.0, 0.4, 20.0])
def test_a_spring_winds_from_where_it_begins(damping: float) -> None:
    """Cut out of a motion, the same second derivative from the state at the cut; by integration from rest."""
    inertia, stiffness, cut = 0.05, 200.0, 700

    def rates(t: float, x: np.ndarray) -> list[float]:
        torque = np.sin(2 * np.pi * 7.0 * t)
        return [x[1], (torque - damping * x[1] - stiffness * x[0]) / inertia]

    x = solve_ivp(rates, (0.0, _T[-1]), [0.0, 0.0], "DOP853", _T, rtol=1e-10, atol=1e-13).y
    second = (_LOAD[:, 0] - damping * x[1] - stiffness * x[0]) / inertia
    whole = spring_wind(_LOAD[:, 0], _STEP, inertia, stiffness, damping)
    assert whole == pytest.approx(second, abs=2e-3 * np.abs(second).max())
    # a torque that is there already has wound the spring up: counted from it, as the motion begins
    load = _LOAD[cut:, 0]
    moved = spring_wind(load - load[0], _STEP, inertia, stiffness, damping)
    state = [x[0, cut] - load[0] / stiffness, x[1, cut]]
    freely = free_wind(len(load), _STEP, inertia, stiffness, damping) @ state
    assert moved + freely == pytest.approx(second[cut:], abs=2e-3 * np.abs(second).max())


def test_springs_of_links_that_feel_nothing_wind_by_themselves() -> None:
    inertia, stiffness, damping = np.array([0.05, 0.02]), np.array([200.0, 90.0]), np.array([0.4, 0.1])
    winds = _winds(_LOAD, _STEP, np.diag(inertia), stiffness, damping)
    for k in range(2):
        alone = spring_wind(_LOAD[:, k], _STEP, inertia[k], stiffness[k], damping[k])
        np.testing.assert_allclose(winds[:, k], alone, rtol=1e-6, atol=1e-6 * np.abs(alone).max())


def test_links_that_feel_each_other_ring_together() -> None:
    """A push on one spring alone: both ring, at the modes of the pair."""
    inertia, stiffness = np.array([[0.05, 0.02], [0.02, 0.03]]), np.array([200.0, 90.0])
    push = np.zeros_like(_LOAD)
    push[0, 0] = 1.0
    winds = _winds(push, _STEP, inertia, stiffness, np.zeros(2))
    rates = np.sqrt(np.linalg.eigvals(np.linalg.solve(inertia, np.diag(stiffness))).real)
    basis = np.concatenate([np.cos(np.outer(_T[5:], rates)), np.sin(np.outer(_T[5:], rates))], axis=1)
    for k in range(2):
        _, left, *_ = np.linalg.lstsq(basis, winds[5:, k], rcond=None)
        assert float(left[0]) < 1e-6 * float(np.sum(winds[5:, k] ** 2))
        assert np.abs(winds[5:, k]).max() > 0.01 * np.abs(winds[5:]).max()


def test_a_steady_torque_leaves_springs_at_rest() -> None:
    winds = _winds(
        np.ones((4000, 2)), _STEP, np.array([[0.05, 0.01], [0.01, 0.02]]), np.array([200.0, 90.0]),
        np.array([1.0, 0.5]),
    )  # fmt: skip
    assert np.abs(winds[-1]).max() == pytest.approx(0.0, abs=1e-6)
