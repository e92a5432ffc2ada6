"""Robots that are alike are left in peace, and one that is not is found."""

import numpy as np
import pytest

from workbench.fleet import spread


@pytest.mark.parametrize(("between", "robots"), [(0.0, 4), (0.0, 12), (3.0, 12)])
def test_few_fleets_of_equals_have_one_that_stands_out(between: float, robots: int) -> None:
    generator = np.random.default_rng(robots)
    stds = generator.uniform(0.5, 2.0, (200, robots))
    values = (
        7.0 + between * generator.standard_normal(stds.shape) + stds * generator.standard_normal(stds.shape)
    )
    alarms = [spread(v, s).stands_out.any() for v, s in zip(values, stds, strict=True)]
    assert np.mean(alarms) < 0.1


def test_scatter_is_told_from_errors_of_estimates() -> None:
    generator = np.random.default_rng(3)
    stds = np.full(60, 0.1)
    alike = spread(2.0 + stds * generator.standard_normal(60), stds)
    apart = spread(2.0 + 0.5 * generator.standard_normal(60) + stds * generator.standard_normal(60), stds)
    assert alike.p_value > 0.01 and alike.ratio == pytest.approx(1.0, abs=0.25)
    assert alike.between < 0.05 and abs(alike.mean - 2.0) < 4.0 * alike.std < 0.1
    assert apart.p_value < 1e-6 and apart.between == pytest.approx(0.5, rel=0.3)
    assert abs(apart.mean - 2.0) < 4.0 * apart.std


def test_the_odd_one_is_named_and_does_not_hide_itself() -> None:
    values, stds = np.array([1.0, 1.02, 0.99, 1.6, 1.01, 0.98]), np.full(6, 0.02)
    told = spread(values, stds)
    assert told.stands_out.tolist() == [False, False, False, True, False, False]
    assert told.deviations[3] == pytest.approx(0.6 / 0.02, rel=0.2)


def test_of_two_nobody_can_say_which_is_odd() -> None:
    told = spread([1.0, 2.0], [0.1, 0.1])
    assert told.p_value < 1e-6 and not told.stands_out.any() and np.isnan(told.deviations).all()
