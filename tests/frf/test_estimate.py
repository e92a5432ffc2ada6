"""Responses from periodic excitation: right on average, and as sure as they say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from workbench.core import Excitation, InputError
from workbench.frf import estimate, estimate_postures, group_by_posture, local_polynomial

from .make import (
    design,
    loop_recordings,
    mimo_plant,
    mimo_recordings,
    mimo_truth,
    recording,
    siso_loop,
    truth,
)
from .sure import distance, noise_std, radius


def binomial(hits: np.ndarray, chance: float, alpha: float = 1e-4) -> bool:
    """Whether a share of independent hits is compatible with a chance."""
    n = hits.size
    low, high = stats.binom.ppf([alpha / 2, 1 - alpha / 2], n, chance)
    return bool(low <= hits.sum() <= high)


def test_without_noise_the_response_is_exact() -> None:
    frf = estimate(loop_recordings(design(periods=3, transient_periods=3), noise=0.0, gain=1.0))
    assert frf.frequency == pytest.approx(np.arange(1.0, 101.0))
    assert np.abs(frf.response[:, 0, 0] / truth(frf.frequency) - 1).max() < 1e-6
    assert frf.coherence.min() > 1 - 1e-9


@pytest.mark.parametrize("periods", [2, 4, 9])
def test_intervals_hold_the_truth_as_often_as_they_say(periods) -> None:
    hits, inside, phases = [], [], []
    for seed in range(12):
        d = design(periods=periods)
        (r,) = loop_recordings(d, noise=0.05, gain=0.8, seed=seed)
        frf = estimate([r], transient_periods=1)
        g, true = frf.response[:, 0, 0], truth(frf.frequency)
        hits.append(np.abs(g - true) < radius(frf, 0.9)[:, 0, 0])
        low, high = (x[:, 0, 0] for x in frf.magnitude_interval(0.9))
        inside.append((low <= np.abs(true)) & (np.abs(true) <= high))
        low, high = (x[:, 0, 0] for x in frf.phase_interval(0.9))
        turn = np.angle(true / g)
        phases.append((low - np.angle(g) <= turn) & (turn <= high - np.angle(g)))
        assert (frf.dof >= 9).all() and frf.periods == periods
    assert binomial(np.array(hits), 0.9)
    assert binomial(np.array(inside), 0.9)
    assert binomial(np.array(phases), 0.9)


def test_feedback_biases_the_plain_quotient_alone() -> None:
    """Noise that goes round the loop pulls Y U^H / (U U^H) towards -1 / controller."""
    d = design(f_max_hz=60, realisations=40, phases="random", periods=2, transient_periods=1, rms=0.5)
    recordings = loop_recordings(d, noise=0.5, gain=3.0)
    good = estimate(recordings, transient_periods=1)
    plain = estimate(recordings, transient_periods=1, reference=None, lines=good.frequency.astype(int))
    true = truth(good.frequency)
    pull = np.conj(-1 / 3.0 - true) / np.abs(-1 / 3.0 - true)

    def bias(frf) -> float:
        along = np.real((frf.response[:, 0, 0] - true) * pull) / frf.std[:, 0, 0]
        return float(np.mean(along) * np.sqrt(2 * len(along)))  # in its own standard deviations

    assert abs(bias(good)) < 4.0
    assert bias(plain) > 8.0


def test_several_inputs_in_a_loop() -> None:
    for n, phases in ((2, "schroeder"), (3, "random")):
        plant = mimo_plant(n)
        d = design(axes=list("abcd")[:n], phases=phases, periods=5, f_max_hz=60)
        chances = []
        for seed in range(6):
            frf = estimate(mimo_recordings(d, plant, noise=0.3, gain=0.02, seed=seed), transient_periods=1)
            assert frf.response.shape == (60, n, n) and frf.method == "noise"
            assert frf.dof == pytest.approx(9 * n) and frf.fresh == pytest.approx(4 * n)
            chances.append(distance(frf, mimo_truth(plant, frf.frequency))[1])
        chances = np.concatenate(chances)
        # p-values of the truth are uniform
        assert binomial(chances < 0.1, 0.1) and binomial(chances < 0.5, 0.5)
        hits = np.abs(frf.response - mimo_truth(plant, frf.frequency)) < radius(frf, 0.9)
        assert hits.mean() > 0.8


def test_an_orthogonal_set_needs_no_reference_and_does_better() -> None:
    plant = mimo_plant(2, seed=3)
    stds = {}
    for mixing in ("orthogonal", "single"):
        d = design(axes=["a", "b"], mixing=mixing, f_max_hz=40)
        with_it = estimate(mimo_recordings(d, plant, noise=0.1, gain=0.0))
        without = estimate(mimo_recordings(d, plant, noise=0.1, gain=0.0), reference=None)
        assert with_it.response == pytest.approx(without.response, rel=1e-9)
        stds[mixing] = np.median(with_it.std)
    assert stds["orthogonal"] == pytest.approx(stds["single"] / np.sqrt(2), rel=0.1)


def test_realisations_are_found_whatever_the_order() -> None:
    plant = mimo_plant(2)
    d = design(axes=["a", "b"], phases="random", realisations=3, f_max_hz=40)
    recordings = mimo_recordings(d, plant, noise=0.1)
    frf = estimate(recordings)
    assert frf.method == "robust" and frf.realisations == 3 and frf.dof == pytest.approx(2)
    by_mode = estimate([*recordings[0::2], *recordings[1::2]])
    assert by_mode.covariance == pytest.approx(frf.covariance)
    assert by_mode.response == pytest.approx(frf.response)


@pytest.mark.parametrize("mixing", ["orthogonal", "single"])
def test_the_same_again_is_no_new_realisation(mixing) -> None:
    """Repeated sets average noise; only new phases show distortion."""
    plant = mimo_plant(2)
    d = design(axes=["a", "b"], mixing=mixing, f_max_hz=40)
    again = [r for seed in range(3) for r in mimo_recordings(d, plant, noise=0.1, seed=seed)]
    for reference in ("auto", None):
        frf = estimate(again, reference=reference)
        assert frf.method == "noise" and frf.realisations == 1
        assert np.median(frf.std / estimate(again[:2]).std) == pytest.approx(1 / np.sqrt(3), rel=0.15)
    new = design(axes=["a", "b"], mixing=mixing, f_max_hz=40, phases="random", realisations=3)
    assert estimate(mimo_recordings(new, plant, noise=0.1)).realisations == 3


def test_total_variance_of_a_linear_system_is_that_of_its_noise() -> None:
    d = design(phases="random", realisations=30, periods=3)
    frf = estimate(loop_recordings(d, noise=0.1, gain=0.5), transient_periods=1)
    ratio = np.mean(frf.std**2) / np.mean(noise_std(frf) ** 2)
    assert ratio == pytest.approx(1.0, abs=0.1)


def test_the_robust_method_sees_what_a_nonlinearity_adds() -> None:
    """Behind a cubic the response scatters between realisations, and hits its mean as often as it says."""
    d = design(phases="random", realisations=8, periods=2, transient_periods=1, grid="odd")
    generator = np.random.default_rng(5)
    many = design(phases="random", realisations=150, periods=2, transient_periods=1, grid="odd", seed=77)

    def play(chosen, noise):
        out = []
        for e in range(len(chosen.trials)):
            r = chosen.play(e)[1]["torque_feedforward"][:, 0]
            _, y = siso_loop(r, np.zeros(len(r)), 0.0)
            y = y + 0.3 * y**3 + noise * generator.normal(size=len(y))
            out.append(recording(y, r, r, design=chosen, experiment=e))
        return out

    frf = estimate(play(d, 0.01))
    best = estimate(play(many, 0.0)).response[:, 0, 0]  # the best linear approximation
    assert np.median(frf.std / noise_std(frf)) > 2
    hits = np.abs(frf.response[:, 0, 0] - best) < radius(frf, 0.9)[:, 0, 0]
    assert binomial(hits, 0.9, 1e-3)


def test_transient_periods_are_found() -> None:
    slow = ((0.0, 0.002), (1.0, -0.998))  # a time constant of one period
    d = design(periods=10, transient_periods=0)
    r = d.play(0)[1]["torque_feedforward"][:, 0]
    for noise, least in ((1e-5, 4), (3e-3, 0)):
        generator = np.random.default_rng(1)
        u, y = siso_loop(r, noise * generator.normal(size=len(r)), 0.0, slow)
        frf = estimate([recording(y + 0.1 * 0.998 ** np.arange(len(y)), u, r, design=d)])
        dropped = 10 - frf.periods
        assert least <= dropped <= 7 if noise < 1e-4 else dropped >= 2
        assert any("transient" in n or "settle" in n for n in frf.notes)
        hits = np.abs(frf.response[:, 0, 0] - truth(frf.frequency, slow)) < radius(frf, 0.95)[:, 0, 0]
        assert hits.mean() > 0.85
    assert not any("transient" in n for n in estimate(loop_recordings(design(), 0.05)).notes)


def test_leakage_of_two_periods_from_rest_is_taken_off() -> None:
    """Without a period to drop, the transient stays in the mean of the spectra and not in the response."""
    ringing = ((0.0, 0.05, 0.04), (1.0, -1.9, 0.95))  # dies away in a sixth of a period
    d = design(periods=2, transient_periods=0)
    r = d.play(0)[1]["torque_feedforward"][:, 0]
    u, y = siso_loop(r, np.zeros(len(r)), 0.0, ringing)
    frf = estimate([recording(y, u, r, design=d)])
    means = (np.fft.rfft(x.reshape(2, 500).mean(axis=0))[1:101] for x in (y, u))
    mean = next(means) / next(means)
    true = truth(frf.frequency, ringing)
    far = np.abs(mean / true - 1)
    assert np.median(np.abs(frf.response[:, 0, 0] / true - 1)) < 0.15 * np.median(far)
    # what is left of it is in the interval
    assert np.mean(np.abs(frf.response[:, 0, 0] - true) < radius(frf, 0.9)[:, 0, 0]) > 0.9


def test_rest_and_fade_before_the_excitation_are_left_out() -> None:
    d = design(periods=4, fade_s=0.7)
    (made,) = loop_recordings(d, noise=0.0)
    rest = np.zeros((333, 1))
    padded = replace(
        made,
        time=np.arange(len(made) + 2 * 333) / 500.0,
        signals={k: np.concatenate([rest + v[0], v, rest]) for k, v in made.signals.items()},
        valid=None,
    )
    frf = estimate([padded], transient_periods=1)
    assert frf.periods == 3
    assert np.abs(frf.response[:, 0, 0] / truth(frf.frequency) - 1).max() < 1e-3


def test_period_and_lines_are_found_where_nothing_is_stated() -> None:
    d = design(grid="odd", f_min_hz=5)
    (r,) = loop_recordings(d, noise=0.02, gain=0.3)
    stated = estimate([r])
    silent = replace(r, excitation=Excitation())
    assert estimate([silent]).response == pytest.approx(stated.response)
    bare = replace(silent, signals={k: v for k, v in r.signals.items() if k != "torque_feedforward"})
    frf = estimate([bare])
    assert np.isin(stated.frequency.round(), frf.frequency.round()).all()
    assert np.abs(frf.response[:, 0, 0] / truth(frf.frequency) - 1).max() < 0.3


def test_a_clock_that_does_not_divide_the_period() -> None:
    """A period of 500.3 rows: the response is right to a part in a thousand up to a third of the rate."""
    d = design(periods=8, transient_periods=0)
    rate = 500.3
    t = np.arange(4000) / rate
    size, phase = np.abs(d.spectrum)[0, :, 0], np.angle(d.spectrum)[0, :, 0]
    wave = np.cos(2 * np.pi * np.outer(t, d.frequency) + phase) @ size
    late = np.cos(2 * np.pi * np.outer(t - 0.004, d.frequency) + phase) @ size
    made = recording(2 * late, wave, rate=rate, design=d)
    frf = estimate([made])
    assert any("interpolated" in n for n in frf.notes)
    true = 2 * np.exp(-2j * np.pi * frf.frequency * 0.004)
    assert frf.frequency == pytest.approx(d.frequency)
    assert np.abs(frf.response[:, 0, 0] - true).max() < 4e-3


def test_postures_are_told_apart() -> None:
    d = design(periods=3)
    made = loop_recordings(d, noise=0.01)
    moved = [replace(r, signals={**r.signals, "position": r.position + 1.0}) for r in made]
    groups = group_by_posture([*made, *moved, *made])
    assert [len(g) for g in groups] == [2, 1]
    frfs = estimate_postures([*made, *moved])
    assert frfs[1].posture[0] - frfs[0].posture[0] == pytest.approx(1.0, abs=0.01)


def test_local_polynomial_and_periods_agree() -> None:
    (r,) = loop_recordings(design(periods=5, transient_periods=0, phases="random"), noise=0.02)
    by_periods = estimate([r], transient_periods=0)
    assert by_periods.method == "noise"
    with pytest.raises(InputError, match="whole period"):
        estimate([replace(r, excitation=Excitation("multisine", period_s=4.0))])
    assert len(local_polynomial([r], f_min_hz=2, f_max_hz=90, reference=None)) > 5
