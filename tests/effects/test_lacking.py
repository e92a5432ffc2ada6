"""Values of springs and bases from the torque that is lacking."""

from __future__ import annotations

import numpy as np

from workbench.effects.lacking import refined


def _valley(values: np.ndarray) -> np.ndarray:
    """A bent, narrow valley of the logarithms, whose end at (1, 1) no few steps reach."""
    x, y = np.log(values)
    return np.array([30.0 * (y - x**2), 1.0 - x])


def test_the_best_start_is_followed_to_the_end() -> None:
    found = refined(_valley, [np.exp([-1.2, 1.0])])
    np.testing.assert_allclose(np.log(found), 1.0, atol=1e-3)
