"""The motion that was made is found from noisy sensors."""

import numpy as np
import pytest

from workbench.core import Recording
from workbench.simulation import smooth_track

ENCODER, SPEED_NOISE = 2 * np.pi / 2**14, 0.015


def truth(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two axes of known position, velocity and acceleration, (N, 2) each."""
    tones = [((0.3, 1.3, 0.2), (0.1, 6.0, 1.0)), ((0.2, 2.1, 0.7), (0.05, 9.0, 2.0))]
    out = np.zeros((3, len(t), 2))
    for i, axis in enumerate(tones):
        for a, f, phase in axis:
            w = 2 * np.pi * f
            out[0, :, i] += a * np.sin(w * t + phase)
            out[1, :, i] += a * w * np.cos(w * t + phase)
            out[2, :, i] -= a * w**2 * np.sin(w * t + phase)
    return out[0], out[1], out[2]


def measured(with_velocity: bool) -> Recording:
    t = np.arange(8000) * 0.001
    q, w, _ = truth(t)
    noise = np.random.default_rng(0).normal(0, SPEED_NOISE, w.shape)
    signals = {"position": np.round(q / ENCODER) * ENCODER}
    if with_velocity:
        signals["velocity"] = w + noise
    return Recording("made", ("a", "b"), "actuator", t, signals, ("rad", "rad"))


#: Root mean square errors of position [rad], velocity [rad/s], acceleration [rad/s^2].
LIMITS = {True: (4e-5, 6e-3, 2.0), False: (5e-5, 8e-3, 3.5)}


@pytest.mark.parametrize("with_velocity", [True, False])
def test_a_known_motion_is_recovered(with_velocity: bool) -> None:
    log = measured(with_velocity)
    std = np.full(2, ENCODER / np.sqrt(12)), np.full(2, SPEED_NOISE if with_velocity else np.nan)
    track = smooth_track(log, None, np.eye(2), *std)
    inside = slice(200, -200)
    found = track.position, track.velocity, track.acceleration
    for estimate, true, limit in zip(found, truth(log.time), LIMITS[with_velocity], strict=True):
        assert np.sqrt(np.mean((estimate - true)[inside] ** 2)) < limit
    raw = np.gradient(np.gradient(log.position, 0.001, axis=0), 0.001, axis=0)
    assert np.sqrt(np.mean((raw - truth(log.time)[2])[inside] ** 2)) > 15 * LIMITS[with_velocity][2]


def test_a_right_simulation_leaves_its_own_noise_free_motion() -> None:
    log = measured(True)
    q, w, a = truth(log.time)
    prior = log.with_signals(position=q, velocity=w)
    std = np.full(2, ENCODER / np.sqrt(12)), np.full(2, SPEED_NOISE)
    track = smooth_track(log, prior, np.eye(2), *std)
    assert np.sqrt(np.mean((track.acceleration - a)[5:-5] ** 2)) < 0.3


def test_tracks_are_in_actuator_coordinates() -> None:
    log, j = measured(True), np.array([[1.0, 0.0], [1.0, 1.0]])
    std = np.full(2, ENCODER / np.sqrt(12)), np.full(2, SPEED_NOISE)
    plain, turned = smooth_track(log, None, np.eye(2), *std), smooth_track(log, None, j, *std)
    np.testing.assert_allclose(turned.position, plain.position @ j.T)
    np.testing.assert_allclose(turned.acceleration, plain.acceleration @ j.T)
