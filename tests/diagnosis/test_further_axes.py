"""Slides of which one lacks little beside what stays strange on the others."""

from __future__ import annotations

import numpy as np
import pytest

from tests.diagnosis.test_everywhere import diagnosed


@pytest.mark.parametrize(("friction", "hum"), [(0.3, 0.1), (0.0, 0.3)])
def test_friction_that_is_small_beside_other_axes_is_found_where_its_axis_shows_it(
    friction: float, hum: float
) -> None:
    told = diagnosed((friction, 1.0, 0.5, 0.3), np.array([hum, 0.5, 0.25, 0.15]))
    named = {f.key.axis: f for f in told.findings}
    assert told.verdict == "missing_effect"
    assert {f.key.effect for f in told.findings} == {"coulomb_friction"}
    assert set(named) == {"y", "z", "u", *("x" if friction else ())}
    if friction:
        torque = named["x"].parameters["torque"]
        assert torque.value == pytest.approx(friction, abs=2.0 * torque.std)
        assert torque.std < 0.1 * friction
        assert named["x"].probability > 0.8
