"""Noise, even and odd distortion told apart on silent lines."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core import InputError
from workbench.frf import detection_lines, distortion, estimate, lines_of

from .make import design, loop_recordings, recording, siso_loop
from .sure import noise_std


def play(even: float, odd: float, noise: float, gain: float = 0.0, seed: int = 0):
    d = design(grid="odd_random", phases="random", periods=6, transient_periods=2, seed=seed)
    r = d.play(0)[1]["torque_feedforward"][:, 0]
    generator = np.random.default_rng(seed)
    _, y = siso_loop(r, np.zeros(len(r)), gain)
    y = y + even * y**2 + odd * y**3 + noise * generator.normal(size=len(y))
    return [recording(y, r, r, design=d)]


@pytest.mark.parametrize(("even", "odd"), [(0.0, 0.0), (0.1, 0.0), (0.0, 0.05), (0.1, 0.05)])
def test_even_and_odd_show_where_they_should(even, odd) -> None:
    for seed in range(3):
        found = distortion(play(even, odd, noise=1e-3, seed=seed))
        assert (found.even > 0.01) == (even > 0) and (found.odd > 0.005) == (odd > 0)
        assert (found.even > 0.0) == (even > 0) and (found.odd > 0.0) == (odd > 0)  # or it is noise


def even_share(y: np.ndarray, lines: np.ndarray) -> float:
    """Share of the even lines of a band in the last period of an output (N,), beside its excited `lines`."""
    spectrum = np.abs(np.fft.rfft(y[-500:]))
    _, even = detection_lines(lines)
    return float(np.sqrt(np.mean(spectrum[even] ** 2) / np.mean(spectrum[lines] ** 2)))


def test_a_share_is_that_of_the_nonlinearity() -> None:
    found = distortion(play(even=0.1, odd=0.0, noise=0.0))
    (made,) = play(even=0.1, odd=0.0, noise=0.0)
    assert found.even[0] == pytest.approx(even_share(made.velocity[:, 0], lines_of(made)), rel=1e-9)


def test_distortion_fed_back_into_the_input_counts_once() -> None:
    """In a linear loop with a nonlinear actuator, input and output are distorted, and the plant is not."""
    d = design(grid="odd_random", phases="random", periods=6, transient_periods=2)
    r = d.play(0)[1]["torque_feedforward"][:, 0]
    generator = np.random.default_rng(0)
    u = r + 0.2 * r**2 + 0.1 * r**3
    _, y = siso_loop(u, np.zeros(len(u)), 0.0)
    y = y + 1e-3 * generator.normal(size=len(y))
    found = distortion([recording(y, u, r, design=d)])
    # the response between lines is interpolated, and that is not perfect at the resonance
    assert found.even.max() < 0.02 and found.odd.max() < 0.02
    assert even_share(y, lines_of(recording(y, u, r, design=d))) > 5 * found.even[0]


def test_the_fast_method_adds_odd_distortion_to_the_variance() -> None:
    clean = estimate(play(0.0, 0.0, noise=1e-3))
    assert clean.method == "fast"
    assert np.median(clean.std / noise_std(clean)) < 1.6
    bent = estimate(play(0.1, 0.05, noise=1e-3))
    assert np.median(bent.std / noise_std(bent)) > 5
    # and about as much as many realisations show
    d = design(grid="odd_random", phases="random", periods=2, transient_periods=2, realisations=60)
    many = []
    for e in range(60):
        r = d.play(e)[1]["torque_feedforward"][:, 0]
        _, y = siso_loop(r, np.zeros(len(r)), 0.0)
        many.append(recording(y + 0.1 * y**2 + 0.05 * y**3, r, r, design=d, experiment=e))
    robust = estimate(many)
    assert robust.realisations == 60
    each = robust.std * np.sqrt(60)
    assert np.median(bent.std / each) == pytest.approx(1.0, abs=0.35)


def test_a_full_grid_cannot_listen() -> None:
    with pytest.raises(InputError, match="no line of the band was left unexcited"):
        distortion(loop_recordings(design(), noise=0.01))
    with pytest.raises(InputError, match="two realisations"):
        estimate(loop_recordings(design(), noise=0.01), method="robust")
