"""The response of a sampled log: exact for any delay, and with exact derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import cont2discrete, freqresp, freqz

from workbench.frf.sampled import System, response, response_and_slopes, second_order

from .machines import DRIVE, ROW, drive_velocity

OMEGA = 2 * np.pi * np.array([0.5, 3.0, 20.0, 99.0, 300.0, 480.0])


def drive(theta: np.ndarray) -> System:
    one = np.ones((1, 1))
    return System(-one * theta[1] / theta[0], one / theta[0], one, theta[2])


@given(delay=st.floats(0.0, 0.01))
@settings(max_examples=25, deadline=None)
def test_a_drive_with_any_delay_is_its_exact_simulation(delay) -> None:
    truth = {**DRIVE, "delay": delay}
    push = np.zeros(6000)
    push[0] = 1.0
    row = np.arange(6000) * ROW
    simulated = np.exp(-1j * OMEGA[:, None] * row) @ drive_velocity(push, **truth)
    found = response(drive(np.array(list(truth.values()))), OMEGA, ROW)[:, 0, 0]
    assert found == pytest.approx(simulated, rel=1e-6, abs=1e-9)


def two_axes(theta: np.ndarray) -> System:
    inertia = np.array([[theta[0], theta[1]], [theta[1], theta[2]]])
    rows = np.concatenate([np.eye(2), np.zeros((2, 2))], axis=1)
    return second_order(inertia, np.diag(theta[3:5]), np.diag(theta[5:7]), theta[7], rows)


THETA = np.array([0.05, 0.005, 0.02, 0.1, 0.2, 1.8, 0.3, 0.0033])


def test_without_delay_it_is_the_zero_order_hold() -> None:
    s = two_axes(np.array([*THETA[:7], 0.0]))
    a, b, c, d, _ = cont2discrete((s.a, s.b, s.c, np.zeros((2, 2))), ROW)
    z = np.exp(1j * OMEGA * ROW)
    theirs = c @ np.linalg.solve(z[:, None, None] * np.eye(4) - a, np.broadcast_to(b, (6, 4, 2))) + d
    assert response(s, OMEGA, ROW) == pytest.approx(theirs, rel=1e-9)
    assert freqz([1], [1], 4)[1] == pytest.approx(1)


def test_without_hold_it_is_the_continuous_response() -> None:
    s = drive(np.array([0.0162, 0.0972, 0.003]))
    theirs = freqresp(([1.0], [0.0162, 0.0972]), OMEGA)[1] * np.exp(-1j * OMEGA * 0.003)
    assert response(s, OMEGA, None)[:, 0, 0] == pytest.approx(theirs)


@pytest.mark.parametrize("hold", [None, ROW])
def test_derivatives_are_those_of_finite_differences(hold) -> None:
    g, slopes = response_and_slopes(two_axes, THETA, OMEGA, hold)
    assert g == pytest.approx(response(two_axes(THETA), OMEGA, hold))
    for p, size in enumerate(THETA):
        step = np.zeros(len(THETA))
        step[p] = 1e-5 * size
        up, down = (response(two_axes(THETA + s), OMEGA, hold) for s in (step, -step))
        assert slopes[p] == pytest.approx((up - down) / (2e-5 * size), rel=1e-5, abs=1e-7 * np.abs(g).max())
