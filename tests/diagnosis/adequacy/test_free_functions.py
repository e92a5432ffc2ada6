"""The size of a law over recordings: it holds in those that can tell it, and others say nothing of it."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.diagnosis.adequacy.free_functions import Adequacy, against_free_functions
from workbench.diagnosis.evidence.shape import splines

_ROWS = 2000  # of each of two recordings


def _friction(changes: float, *, missing: bool = False, seed: int) -> Adequacy:
    """Dry friction beside a constant and a slow unknown torque; the drive turns one way, then the other.

    It `changes` by so much within a recording. Where it is `missing`, the second recording has none.
    """
    random, count = np.random.default_rng(seed), 2 * _ROWS
    way, time = np.repeat([1.0, -1.0], _ROWS), np.arange(count, dtype=float)
    speed = way * (2.0 + 1e-3 * random.standard_normal(count))
    friction = 0.35 * way * (1.0 + changes * random.standard_normal(count))
    rest = 0.01 * random.standard_normal(count) + 0.02 * np.sin(time / 300.0)
    rest -= friction * (missing & (way < 0.0))
    laws = np.column_stack([friction, np.full(count, -0.09)])
    own, beside = splines([speed], [speed]), splines([time], [time])
    return against_free_functions(laws, rest, [(own, friction)], [beside], np.repeat([0, 1], _ROWS))


@pytest.mark.parametrize("seed", [1, 3, 6, 7])
def test_turning_one_way_says_nothing_of_friction(seed: int) -> None:
    """There a constant torque does the same, and the unknown one decides between them."""
    assert _friction(1e-3, seed=seed).size > 0.9


def test_a_recording_that_can_tell_has_the_law_or_it_is_none() -> None:
    assert _friction(0.5, seed=0).size > 0.9
    assert _friction(0.5, missing=True, seed=0).size < 0.1


def test_a_size_that_varies_along_the_way_is_said_to() -> None:
    """Friction of a rough patch: by how much its size varies is what the interval has to cover."""
    random, count = np.random.default_rng(2), 2 * _ROWS
    position, speed = np.sin(np.arange(count) / 90.0), np.cos(np.arange(count) / 90.0)
    rough = 0.4 + 0.3 * (position > 0.3)
    torque = rough * np.sign(speed) + 0.01 * random.standard_normal(count)
    law = np.sign(speed) * (torque @ np.sign(speed) / count)
    beside = splines([position], [position])
    varying = law[:, None] * beside[0], beside[1]
    found = against_free_functions(
        law[:, None], torque - law, [(varying, law)], [beside], np.repeat([0, 1], _ROWS)
    )
    assert found.variation == pytest.approx(np.std(rough) / np.mean(rough), rel=0.1)
    assert Adequacy(1.0, 1.0, 0.0).variation == 0.0
