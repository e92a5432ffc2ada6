"""Limits that go on past dead points: what of them a mechanism can be used in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench.core import InputError
from workbench.models import Model, read_model
from workbench.s3n import PostureChain, PostureDependent, reach


def _with_limits(name: str, *limits: tuple[float, float]) -> Model:
    model = read_model(name)
    assert model.closed_chain is not None
    return replace(model, closed_chain=replace(model.closed_chain, limits=limits))


@pytest.mark.parametrize("name", ["four_bar", "five_bar", "ankle"])
def test_limits_that_can_be_used_stay(name: str) -> None:
    model = read_model(name)
    assert model.closed_chain is not None
    found = reach(model)
    assert found.left_out == () and found.of(model).closed_chain == model.closed_chain


def test_what_lies_beyond_a_dead_point_is_left_out_and_told() -> None:
    model = _with_limits("four_bar", (-1.6, 1.6), (-1.0, 3.1))
    with pytest.raises(InputError):
        PostureDependent(model)
    found = reach(model)
    assert found.box[0].tolist() == [-1.6, 1.6]
    low, high = found.box[1]
    assert -1.0 < low < 0.5 and 2.4 < high <= 3.1
    assert found.left_out[0].startswith(f"knee from -1 to {low:g}, where drives ")
    PostureDependent(found.of(model))  # what is left can be used as a whole
    margin = PostureChain(found.of(model)).margin(np.array([[0.0, low], [0.0, (low + high) / 2.0]]))
    assert margin[0] > 0.2 * margin[1]


def test_two_joints_that_share_loops() -> None:
    model = _with_limits("five_bar", (0.4, 1.4), (-2.6, -1.2))
    found = reach(model)
    assert found.left_out and all("where loops" in line for line in found.left_out)
    assert np.ptp(found.box, axis=1).min() > 0.3
    PostureDependent(found.of(model))


def test_limits_that_somebody_chose_are_kept() -> None:
    model = _with_limits("five_bar", (0.4, 1.4), (-2.6, -1.2))
    found = reach(model, kept=["drive_1"])
    assert found.box[0].tolist() == [0.4, 1.4]
    assert found.box[1, 0] > -2.6 and "knee_1 from -2.6" in found.left_out[0]


def test_no_part_of_the_limits_can_be_used() -> None:
    model = _with_limits("five_bar", (0.4, 1.4), (-3.0, 0.5))
    with pytest.raises(InputError, match="dead points"):
        reach(model, kept=["knee_1"])
