"""Responses from records that do not repeat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter

from workbench.core import InputError
from workbench.frf import chirp, local_polynomial

from .make import PLANT, RATE, mimo_plant, mimo_truth, recording, siso_loop, truth
from .sure import distance, radius, within


def noisy(seed: int, rows: int = 4000, noise: float = 0.1):
    generator = np.random.default_rng(seed)
    u = generator.normal(size=rows)
    # an initial state that rings for a while
    y = lfilter(*PLANT, u, zi=[3.0, -1.0])[0] + noise * lfilter([1, 0.5], [1], generator.normal(size=rows))
    return recording(y, u)


def test_a_known_system_with_a_transient_without_noise() -> None:
    frf = local_polynomial([noisy(0, noise=0.0)], f_min_hz=2, f_max_hz=200)
    relative = np.abs(frf.response[:, 0, 0] / truth(frf.frequency) - 1)
    assert relative.max() < 2e-3  # polynomials of order two over windows of 19 lines
    # dividing spectra, as one would without, is far off
    r = noisy(0, noise=0.0)
    u, y = (np.fft.rfft(r.signals[s][:, 0]) for s in ("torque_measured", "velocity"))
    plain = (y / u)[np.round(frf.frequency * 8).astype(int)]
    assert np.max(np.abs(plain / truth(frf.frequency) - 1)) > 0.1


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    hits = []
    for seed in range(12):
        frf = local_polynomial([noisy(seed)], f_min_hz=2, f_max_hz=200)
        hits.append(np.abs(frf.response[:, 0, 0] - truth(frf.frequency)) < radius(frf, 0.9)[:, 0, 0])
    hits = np.array(hits)
    low, high = stats.binom.ppf([1e-4, 1 - 1e-4], hits.size, 0.9)
    assert low <= hits.sum() <= high


def test_in_a_loop_the_reference_takes_the_bias_away() -> None:
    good, plain = [], []
    for seed in range(10):
        generator = np.random.default_rng(seed)
        r, e = generator.normal(size=(2, 4000))
        u, y = siso_loop(r, 0.3 * e, 1.5)
        made = recording(y, u, r)
        for found, options in ((good, {}), (plain, {"reference": None, "halfwidth": 9, "step": 19})):
            frf = local_polynomial([made], f_min_hz=2, f_max_hz=200, **options)
            found.append(np.mean(np.real((frf.response[:, 0, 0] - truth(frf.frequency)) / frf.std[:, 0, 0])))
    assert abs(np.mean(good)) < 0.35 * abs(np.mean(plain))


def test_several_inputs_from_one_record_or_two() -> None:
    plant = mimo_plant(2)
    a, b, c = plant
    generator = np.random.default_rng(2)
    records = []
    for k in range(2):
        u = generator.normal(size=(4000, 2))
        state, y = np.full(4, 2.0), np.empty((4000, 2))
        for i, push in enumerate(u):
            y[i] = c @ state
            state = a @ state + b @ push
        y += 0.2 * generator.normal(size=y.shape)
        records.append(recording(y[k * 137 :], u[k * 137 :]))
    for chosen in (records[:1], records):
        frf = local_polynomial(chosen, f_min_hz=2, f_max_hz=200)
        chance = distance(frf, mimo_truth(plant, frf.frequency))[1]
        assert 0.02 < np.mean(chance < 0.2) < 0.45
        assert np.median(chance) == pytest.approx(0.5, abs=0.2)


def test_chirps_of_two_axes() -> None:
    d = chirp(["a", "b"], f_min_hz=1, f_max_hz=60, duration_s=20, rate_hz=RATE, sweep="linear",
              driven="torque_feedforward")  # fmt: skip
    plant = mimo_plant(2)
    a, b, c = plant
    generator = np.random.default_rng(0)
    records = []
    for e in range(2):
        u = d.play(e)[1]["torque_feedforward"]
        state, y = np.zeros(4), np.empty_like(u)
        for i, push in enumerate(u):
            y[i] = c @ state
            state = a @ state + b @ push
        records.append(recording(y + 0.01 * generator.normal(size=y.shape), u, design=d, experiment=e))
    frf = within(local_polynomial(records), 5, 50)
    error = np.abs(frf.response - mimo_truth(plant, frf.frequency))
    assert np.mean(error < radius(frf, 0.9)) > 0.8
    assert np.median(error / np.abs(frf.response)) < 5e-3


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"f_max_hz": 300.0}, "half the rate"),
        ({"f_min_hz": 50.0, "f_max_hz": 40.0}, "band"),
        ({"f_min_hz": 50.0, "f_max_hz": 51.0}, "not enough"),
        ({"halfwidth": 2}, "not enough"),
    ],
)
def test_windows_that_cannot_be_are_refused(options, words) -> None:
    with pytest.raises(InputError, match=words):
        local_polynomial([noisy(1)], **options)


def test_inputs_that_move_together_are_refused() -> None:
    r = noisy(1)
    u = np.tile(r.signals["torque_measured"], (1, 2))
    twin = recording(np.tile(r.velocity, (1, 2)), u)
    with pytest.raises(InputError, match="told apart"):
        local_polynomial([twin, twin], f_min_hz=2, f_max_hz=100)
    holes = replace(r, valid=np.arange(len(r)) != 99)
    with pytest.raises(InputError, match="row 100"):
        local_polynomial([holes])
