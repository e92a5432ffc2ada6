"""While a case is diagnosed once, what would have been decided with other thresholds is noted."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from policy_sweep import values
from watched import Notes
from watching import watching

from tests.free_motion import friction, pendulum, recorded, swing
from workbench.core import Diagnosis
from workbench.diagnosis import data, diagnose
from workbench.diagnosis.policy import POLICY, Policy

LESS, MORE = values("at_noise")  # of 1.25: 1.0 and 1.5
rows, one = np.array([0.5, 1.1, 2.0]), np.float64(1.4)


def noted(decide: Callable[[], Any]) -> tuple[Any, Notes]:
    """What comes out, and what is noted of `at_noise`."""
    with watching(values) as notes:
        out = decide()
    return out, notes


@pytest.mark.parametrize(
    ("decide", "plain", "flips"),
    [
        (lambda: one < POLICY.at_noise, False, {MORE}),
        (lambda: float(one) < POLICY.at_noise, False, {MORE}),
        (lambda: POLICY.at_noise > one, False, {MORE}),
        (lambda: 3.0 * POLICY.at_noise >= np.float64(3.3), True, {LESS}),
        (lambda: one * POLICY.at_noise >= 1.5, True, {LESS}),
        (lambda: POLICY.at_noise < 2.0, True, set()),
        (lambda: 7 - np.maximum(POLICY.at_noise, 1.6) > 5.0, True, set()),
        (lambda: (rows < POLICY.at_noise).all(), False, set()),
        (lambda: np.any(POLICY.at_noise * np.ones(2) < rows[:2]), False, {LESS}),
        (lambda: np.sum(rows * 1.3 < POLICY.at_noise), 1, {MORE}),
        (lambda: np.argmin(np.abs(rows - POLICY.at_noise)), 1, set()),
        (lambda: np.searchsorted(rows, np.maximum(POLICY.at_noise, one) + 0.6), 2, {MORE}),
        (lambda: np.where(rows > POLICY.at_noise, 0.0, rows).sum() > 1.0, True, {LESS}),
        (lambda: np.flatnonzero(rows > POLICY.at_noise)[0] == 2, True, {LESS}),
        (lambda: len(np.flatnonzero(rows < POLICY.at_noise)), 2, {LESS}),
        (lambda: sorted([POLICY.at_noise, 1.3, 2.0])[0] == 1.3, False, {MORE}),
    ],
)
def test_a_comparison_that_a_value_turns_is_found_alone(
    decide: Callable[[], Any], plain: Any, flips: set[float]
) -> None:
    with watching(values) as notes:
        assert decide() == plain
    assert {value for name, value in notes.flips} == flips
    assert all(place.startswith("tests/benchmarks/test_watching.py:") for place in notes.flips.values())
    assert notes.read == {"at_noise"}


def test_least_and_most_decide_only_with_what_follows() -> None:
    here = vars(data)
    with watching(values) as notes:
        most, number = here["max"](1.1, POLICY.at_noise), here["float"](POLICY.at_noise)
        assert most > 1.05 and number > 0.9
        assert here["min"](x * POLICY.at_noise for x in (1.0, 2.0)) == 1.25
        assert np.zeros(2, here["float"]).dtype == np.float64
        below = np.flatnonzero(rows < POLICY.near_noise)
        assert here["len"](below) and here["len"](rows) == 3
    assert set(notes.flips) == {("at_noise", LESS), ("at_noise", MORE)}, "by the equality alone"
    assert not notes.escapes and "float" not in here


def test_what_leaves_as_another_plain_number_is_an_escape() -> None:
    def opaque() -> None:
        assert list(islice(rows, POLICY.most_effects)) == list(rows)
        assert "12345"[: POLICY.shift_rows] == "12345"
        assert math.sqrt(POLICY.near_noise) == math.sqrt(2.0)
        assert list(range(int(POLICY.screened_times))) == list(range(10))
        plain = np.ones(3)
        plain *= POLICY.tie
        plain[0] = POLICY.noise_slack
        assert plain.tolist() == [1.03, 0.03, 0.03]
        assert np.asarray([POLICY.sure, 1.0]).sum() == 5.0
        assert np.linalg.norm(np.ones(5000) * POLICY.chance_gain) > 0.0
        assert math.sqrt(max(POLICY.explained, 2.0)) > 1.0

    _, notes = noted(opaque)
    left = ["most_effects", "shift_rows", "near_noise", "screened_times", "tie", "noise_slack", "sure"]
    assert set(notes.escapes) == {(name, v) for name in (*left, "chance_gain") for v in values(name)}
    assert "explained" in notes.read and not notes.flips


def test_after_a_flip_nothing_is_noted_and_words_do_nothing() -> None:
    def decide() -> str:
        first = POLICY.at_noise > 1.4
        return f"{first} {POLICY.at_noise + 0.2 > 1.6} {math.sqrt(POLICY.at_noise):.3f} {POLICY.tie:g}"

    text, notes = noted(decide)
    assert text == "False False 1.118 0.03"
    assert set(notes.flips) == {("at_noise", MORE)}
    assert set(notes.shown) == {("tie", v) for v in values("tie")}


def test_how_comparisons_came_out() -> None:
    def decide() -> None:
        assert one > POLICY.at_noise and not one > POLICY.near_noise
        assert (rows > POLICY.tie).all() and (rows > POLICY.noise_slack).any()

    _, notes = noted(decide)
    both = {True, False}
    assert notes.outcomes == {"at_noise": {True}, "near_noise": {False}, "tie": {True}, "noise_slack": both}


def test_numbers_are_plain_afterwards_whatever_happened() -> None:
    with pytest.raises(RuntimeError), watching(values):
        raise RuntimeError
    assert type(POLICY.tie) is float and Policy() == POLICY


def test_a_diagnosis_answers_as_it_does_without_watching(tmp_path: Path) -> None:
    logs = [
        recorded(swing(a, friction(viscous=0.012), 0.0, 4.0), seed=k) for k, a in enumerate((1.2, 0.6, 0.9))
    ]

    def asked() -> Diagnosis:
        return diagnose(pendulum(tmp_path), logs[:2], logs[2:])

    alone, (watched, notes) = asked(), noted(asked)
    for one, other in zip(alone.findings, watched.findings, strict=True):
        assert one.key == other.key and one.probability == other.probability
        assert all(
            (e.value, e.std) == (other.parameters[name].value, float(other.parameters[name].std))
            for name, e in one.parameters.items()
        )
    assert (alone.verdict, alone.error, alone.work) == (watched.verdict, watched.error, watched.work)
    assert alone.evidence == watched.evidence and alone.ranking == watched.ranking
    assert {"effect_gain", "tie"} <= notes.read
    assert not {name for name, _ in notes.flips} >= notes.read
