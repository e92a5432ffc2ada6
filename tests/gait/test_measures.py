"""Frequency, duty factor, cycles, and the three parts of a gap, where all of them are known."""

from dataclasses import replace

import numpy as np
import pytest

from tests.gait.make import PERIOD, walk
from workbench.core import InputError
from workbench.gait import compare_gaits, resampled, split, strides_of, tracking
from workbench.gait.strides import strides_alike

T = PERIOD * np.arange(round(8.0 / PERIOD))


@pytest.mark.parametrize("frequency", [0.9, 2.5, 5.0])
def test_strides_are_seen_through_noise_and_harmonics(frequency: float) -> None:
    phase = 2.0 * np.pi * frequency * T
    generator = np.random.default_rng(1)
    x = np.sin(phase) + 0.9 * np.sin(2.0 * phase + 1.0) + 0.1 * generator.standard_normal(len(T))
    found = strides_of(x, PERIOD)
    assert found is not None
    assert found.frequency.low <= frequency * 1.001 and found.frequency.high >= frequency * 0.999
    assert found.frequency.value == pytest.approx(frequency, rel=0.01)


def test_noise_and_rest_have_no_strides() -> None:
    assert strides_of(np.zeros(1000), PERIOD) is None
    assert strides_of(np.random.default_rng(0).standard_normal(3000), PERIOD) is None


@pytest.mark.parametrize("uneven", [(0.25, 0.32), (0.32, 0.25), (0.32, 0.0), (0.0, 0.32)])
def test_steps_that_differ_in_turn_are_counted_alike(uneven: tuple[float, float]) -> None:
    """After one stride they are alike by 0.88, 0.81 or 1: at the edge of what is taken for a stride."""
    both = [
        np.sin(2.0 * np.pi * f * T) + a * np.sin(np.pi * f * T)
        for f, a in zip((2.5, 2.6), uneven, strict=True)
    ]
    one, other = strides_alike(both, PERIOD)
    assert one is not None and other is not None
    assert other.frequency.value / one.frequency.value == pytest.approx(1.04, rel=0.01)


def test_a_run_whose_strides_are_quicker_by_far_keeps_them() -> None:
    """Counted by two they would be nearer: 2.5 Hz to 3.6 Hz is farther than to 1.8 Hz."""
    slow, quick = np.sin(5.0 * np.pi * T), np.sin(7.2 * np.pi * T) + 0.25 * np.sin(3.6 * np.pi * T)
    one, other = strides_alike([slow, quick], PERIOD)
    assert one is not None and other is not None
    assert other.frequency.value == pytest.approx(3.6, rel=0.01)


def test_strides_of_twice_the_frequency_are_told() -> None:
    one, other = strides_alike([np.sin(2.0 * np.pi * f * T) for f in (2.5, 5.0)], PERIOD)
    assert one is not None and other is not None
    assert other.frequency.value / one.frequency.value == pytest.approx(2.0, rel=0.01)
    assert strides_alike([np.sin(5.0 * np.pi * T), np.zeros(len(T))], PERIOD)[1] is None


def test_the_parts_of_a_gap_are_what_was_put_in() -> None:
    slow, ripple = 0.03 * np.sin(2 * np.pi * 0.25 * T), 0.05 * np.sin(2 * np.pi * 2.5 * T)
    parts = split(0.02 + slow + ripple, PERIOD)
    np.testing.assert_allclose(parts.bias, 0.02, atol=1e-4)
    np.testing.assert_allclose(parts.slow, slow, atol=1e-3)
    np.testing.assert_allclose(parts.ripple, ripple, atol=1e-3)
    squares = [np.mean(x**2) for x in (parts.bias, parts.slow, parts.ripple)]
    assert sum(squares) == pytest.approx(np.mean(parts.whole**2))


def test_e_phi_and_rmse_are_shares_of_the_command() -> None:
    one = np.stack([np.full_like(T, 0.8), np.full_like(T, 0.5)], axis=1)
    other = one + np.stack([0.08 * np.ones_like(T), 0.1 * np.sign(np.sin(2 * np.pi * 4.0 * T))], axis=1)
    made = tracking(one, other, np.array([0.8, 0.5]), PERIOD)
    assert made.phase["whole"].value == pytest.approx(15.0, rel=0.01)  # half of 10 % and 20 %
    assert made.phase["bias"].value == pytest.approx(5.0, abs=0.1)
    assert made.phase["ripple"].value == pytest.approx(10.0, abs=0.2)
    assert made.rmse["ripple"].value == pytest.approx(10.0, abs=0.2)
    assert made.phase["slow"].value < 0.2


def test_an_interval_holds_the_truth_as_often_as_it_says() -> None:
    generator = np.random.default_rng(5)
    inside = 0
    for k in range(200):
        blocks = 1.0 + generator.standard_normal((30, 1))
        found = resampled(lambda m: m[..., 0], blocks, seed=k)
        inside += found.low <= 1.0 <= found.high
    assert 178 <= inside <= 199
    assert resampled(lambda m: m[..., 0], np.ones((2, 1))).high == np.inf


def gaps(made) -> dict[str, tuple[float, float]]:
    return {m.name: (m.gap.value, m.floor.value if m.floor else np.nan) for m in made.measures}


def test_two_gaits_apart_by_what_is_known() -> None:
    generator = np.random.default_rng(2)
    hardware = walk(noise=0.002)
    faster = walk(frequency=2.75, duty=0.5, force=60.0, lift=0.25, noise=0.002, seed=1)
    again = walk(forward=0.8 + 0.01 * generator.standard_normal(len(T)), noise=0.002, seed=2)
    made = compare_gaits(hardware, faster, again, command=(0.8, 0.5))
    found = gaps(made)
    assert found["stride frequency"] == pytest.approx((10.0, 0.0), abs=0.1)
    assert found["duty factor"][0] == pytest.approx(-0.1, abs=0.01)
    assert found["joint angles over the stride"][0] == pytest.approx(1e3 * 0.05 / np.sqrt(2.0), rel=0.03)
    assert found["joint angles over the stride"][1] < 1.0
    assert found["torque over the stride"][0] == pytest.approx(3.0 * 0.05 / np.sqrt(2.0), rel=0.05)
    assert found["foot force over the stride"][0] > 5.0 > found["foot force over the stride"][1]
    assert found["E_phi"][0] == pytest.approx(0.0, abs=1e-9) and 0.3 < found["E_phi"][1] < 0.7
    assert not made.lacking
    assert "stride frequency" in repr(made) and "array(" not in repr(made) + made._repr_html_()


def test_measures_that_can_be_made_are_and_others_are_named() -> None:
    hardware = walk()
    blind = replace(hardware, extra={})
    made = compare_gaits(blind, blind)
    assert {m.name for m in made.measures} == {
        "stride frequency", "joint angles over the stride", "torque over the stride",
    }  # fmt: skip
    said = " ".join(made.lacking)
    assert "E_phi needs base_orientation" in said and "duty factor needs ground_force" in said
    with pytest.raises(InputError, match="nothing is left"):
        compare_gaits(hardware, hardware, start_s=100.0)
    with pytest.raises(InputError, match="axes"):
        compare_gaits(hardware, replace(hardware, axes=("a", "b", "c", "d")))
