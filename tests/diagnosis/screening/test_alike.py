"""Joints of one design have one size of an effect, where the recordings agree with that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.screening.test_torque_regression import ROWS, entry, problem
from workbench.diagnosis.screening.alike import in_common
from workbench.diagnosis.screening.selection import Selection, selection_of
from workbench.diagnosis.screening.stepwise_regression import grown
from workbench.diagnosis.screening.torque_regression import Regression

AXES = "front left", "front right", "rear left", "rear right"
NOISE = 0.03  # whose square is about what `problem` takes for noise


def legs(sizes: list[float], motion: list[float]) -> Regression:
    """Damping of these sizes on four axes that move by so much, and the same at one size on all."""
    random = np.random.default_rng(3)
    own = np.zeros((ROWS, 4, 4))
    for k, moved in enumerate(motion):
        own[:, k, k] = moved * random.normal(size=ROWS)
    torque = np.einsum("knc,c->kn", own, sizes) + NOISE * random.normal(size=(ROWS, 4))
    each = [entry("viscous_damping", axis, k) for k, axis in enumerate(AXES)]
    common = replace(entry("viscous_damping", AXES[0], 4), alike=tuple(each))
    columns = np.concatenate([own, own.sum(axis=-1, keepdims=True)], axis=-1)
    bare = problem(columns, torque, [*each, common])
    return replace(bare, entries=tuple(each), alike=(common,))


def found(sizes: list[float], motion: list[float]) -> tuple[Selection, dict[str | None, float]]:
    regression = legs(sizes, motion)
    one_by_one = grown(selection_of((), regression), regression, regression.entries)
    common = in_common(one_by_one, regression)
    names = [e.key.axis for e in common.chosen]
    return common, dict(zip(names, common.solution.coefficients.tolist(), strict=True))


def test_legs_that_agree_have_one_size() -> None:
    common, sizes = found([0.3] * 4, [1.0] * 4)
    assert set(sizes) == set(AXES) and len(set(sizes.values())) == 1
    assert sizes[AXES[0]] == pytest.approx(0.3, abs=0.003)
    assert [len(keys) for keys in common.shared] == [4]


def test_a_leg_that_hardly_moves_has_the_size_of_the_others() -> None:
    _, sizes = found([0.3] * 4, [1.0, 1.0, 1.0, 0.03])
    assert sizes[AXES[3]] == sizes[AXES[0]] == pytest.approx(0.3, abs=0.003)


def test_a_leg_that_differs_keeps_its_own_size() -> None:
    common, sizes = found([0.3, 0.3, 0.3, 0.6], [1.0] * 4)
    assert not common.shared
    assert sizes[AXES[3]] == pytest.approx(0.6, abs=0.01)
    assert sizes[AXES[0]] == pytest.approx(0.3, abs=0.01)


def test_what_one_leg_alone_shows_is_not_given_to_all() -> None:
    _, sizes = found([0.3, 0.0, 0.0, 0.0], [1.0] * 4)
    assert set(sizes) == {AXES[0]}


def test_where_nothing_is_missing_nothing_is_shared() -> None:
    common, sizes = found([0.0] * 4, [1.0] * 4)
    assert not sizes and not common.shared
