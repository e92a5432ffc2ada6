"""An excitation shrunk until the machine can bear it."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core import InputError, SimulationError
from workbench.frf import Design, Limit, multisine, scale_to_limits


def design(rms: float = 1.0) -> Design:
    return multisine(["a"], f_min_hz=1, f_max_hz=20, period_s=1, rate_hz=200, rms=rms)


def predict(d: Design) -> dict[str, np.ndarray]:
    torque = np.concatenate([[0.0], d.experiments[0, :, 0]])[:, None]
    return {"torque": torque, "position": 0.1 * torque + 0.02 * torque**3 + 0.5, "speed": 2.0 * torque}


LIMITS = (
    Limit("position", "a", 0.0, 1.0, "rad"),
    Limit("speed", "a", -4.0, 4.0, "rad/s"),
    Limit("torque", "a", -24.0, 24.0, "N m"),
)


def test_small_enough_is_left_alone() -> None:
    small = design(0.5)
    scaled = scale_to_limits(small, predict, LIMITS)
    assert scaled.factor == 1.0 and scaled.design is small
    assert scaled.binding is not None and scaled.binding.quantity == "speed"


@pytest.mark.parametrize("rms", [2.0, 20.0, 60.0])
def test_too_large_is_shrunk_to_the_binding_limit(rms) -> None:
    scaled = scale_to_limits(design(rms), predict, LIMITS)
    assert scaled.binding is not None and scaled.binding.quantity == "speed"
    assert 0.85 < scaled.usage[scaled.binding] <= 0.95 + 1e-9
    speed = predict(scaled.design)["speed"]
    assert 3.4 < np.abs(speed).max() <= 3.81
    assert scaled.design.experiments == pytest.approx(design(rms * scaled.factor).experiments)


def test_two_columns_go_by_the_order_of_their_limits() -> None:
    limits = (Limit("speed", "a", -9, 9), Limit("torque", "a", -2, 2), Limit("speed", "b", -1, 1))
    both = {"torque": np.array([[0.0], [1.0]]), "speed": np.array([[0.0, 0.0], [1.0, -0.9]])}
    scaled = scale_to_limits(design(), lambda d: both, limits)
    assert scaled.binding is not None and scaled.binding.name == "b"


def test_a_posture_outside_is_refused() -> None:
    with pytest.raises(InputError, match="at rest"):
        scale_to_limits(design(), predict, [Limit("position", "a", 0.6, 1.0, "rad")])


def test_a_load_that_does_not_shrink_is_refused() -> None:
    def heavy(d: Design) -> dict[str, np.ndarray]:
        return {"torque": np.array([[0.0], [3.0]])}

    with pytest.raises(InputError, match="torque of a"):
        scale_to_limits(design(), heavy, [Limit("torque", "a", -2, 2, "N m")])


def test_a_simulation_that_fails_is_tried_smaller() -> None:
    def fragile(d: Design) -> dict[str, np.ndarray]:
        if np.abs(d.experiments).max() > 0.5:
            raise SimulationError("unstable")
        return predict(d)

    assert 0.05 < scale_to_limits(design(4.0), fragile, LIMITS).factor < 0.2
