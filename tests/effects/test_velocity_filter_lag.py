from __future__ import annotations

import numpy as np
import pytest

from workbench.effects.velocity_filter_lag import lagged


@pytest.mark.parametrize("time_constant", [0.0, 1e-320, 1e-12])
def test_no_lag_changes_nothing(time_constant: float) -> None:
    values = np.sin(np.arange(50.0))
    assert np.allclose(lagged(values, 0.001, time_constant), values)


def test_a_lag_follows() -> None:
    step = np.r_[np.zeros(10), np.ones(90)]
    assert lagged(step, 0.001, 0.01)[-1] == pytest.approx(1.0, abs=1e-3)
    assert 0.5 < lagged(step, 0.001, 0.01)[20] < 0.8
