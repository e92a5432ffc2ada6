"""A reference of the wrong sign is seen without a command; a loop that is too slow is none."""

from __future__ import annotations

import numpy as np
import pytest

from tests.planar_leg import moved, turned, without
from workbench.core import Recording
from workbench.inspection import inspect


def opposed(recording: Recording) -> list[str | None]:
    remarks = inspect([recording]).recordings[0].remarks
    return [r.axis for r in remarks if r.topic == "sign" and "minus its reference" in r.text]


def followed(gain: float = 1.0) -> Recording:
    """The leg's motion right behind what was asked, no command logged."""
    log = without(moved(), "torque_command")
    late = np.roll(log.position, 5, axis=0)
    late[:5] = log.position[0]
    return log.with_signals(position_reference=np.roll(late, -8, axis=0) / gain)


@pytest.mark.parametrize("axis", ["hip", "knee"])
def test_a_reference_that_counts_the_other_way(axis: str) -> None:
    assert opposed(turned(followed(), axis, "position_reference")) == [axis]
    assert opposed(followed()) == []


def test_a_loop_driven_too_fast_answers_the_other_way_but_less() -> None:
    log = followed()
    t = log.time[:, None]
    away = log.with_signals(
        position=0.3 * np.sin(60 * t) * [1, 1], position_reference=-np.sin(60 * t) * [1, 1]
    )
    assert opposed(away) == []


def test_a_reference_in_degrees_beside_radians_is_told() -> None:
    log = followed()
    assert log.get("position_reference") is not None
    for factor, meaning in ((57.29578, "degrees and radians"), (0.001, "milli")):
        sagging = log.signals["position_reference"] + [0.2 * np.ptp(log.position[:, 0]), 0.0]
        asked = sagging * [factor, 1.0]
        remarks = inspect(log.with_signals(position_reference=asked)).recordings[0].remarks
        [told] = [r for r in remarks if r.topic == "unit" and r.severity == "problem"]
        assert told.axis == "hip" and meaning in told.text
        assert told.value["factor"] == pytest.approx(factor, rel=0.1)
    soft = log.with_signals(position_reference=log.signals["position_reference"] * 10.0)
    assert not [r for r in inspect(soft).recordings[0].remarks if r.severity == "problem"], "a soft loop"
