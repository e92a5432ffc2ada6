"""Rows in which drives are off are masked and named; drives that only give less are not."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core import Controller
from workbench.recordings.dead import dead_note, dead_rows

STEP = 0.002
T = np.arange(5000) * STEP
RNG = np.random.default_rng(0)
ASKED = np.column_stack([3 * np.sin(9 * T) + np.sin(31 * T), 0.5 * np.cos(5 * T) + 0.3 * np.sin(17 * T)])
UNKNOWN = Controller()


def given(*spans: tuple[float, float], axes: tuple[int, ...] = (0, 1), noise: float = 0.02) -> np.ndarray:
    torque = ASKED.copy()
    for start, end in spans:
        for i in axes:
            torque[(start <= T) & (end > T), i] = 0.0
    return torque + RNG.normal(0, noise, torque.shape) if noise else torque


def found(measured: np.ndarray, asked: np.ndarray | None = ASKED) -> np.ndarray:
    signals = {"position": 0 * ASKED, "velocity": 0 * ASKED, "torque_measured": measured}
    if asked is not None:
        signals["torque_command"] = asked
    return dead_rows(signals, np.ones(len(T), bool), STEP, UNKNOWN, "joint")


@pytest.mark.parametrize("noise", [0.0, 0.02])
@pytest.mark.parametrize("spans", [[(6.0, 10.0)], [(0.0, 1.5)], [(3.0, 3.6)], [(2.0, 2.5), (7.0, 10.0)]])
def test_silence_while_torque_is_asked_for(spans: list[tuple[float, float]], noise: float) -> None:
    dead = found(given(*spans, noise=noise)).any(axis=1)
    off = np.any([(start <= T) & (end > T) for start, end in spans], axis=0)
    assert (dead & off).sum() > 0.97 * off.sum() and (dead & ~off).sum() < 60


def test_one_drive_of_two() -> None:
    dead = found(given((6.0, 10.0), axes=(1,)))
    assert not dead[:, 0].any() and dead[3100:, 1].all()
    note = dead_note(dead, ("hip", "knee"), STEP)
    assert note.startswith("From 6 s on the drive of 'knee' gives no torque")


def test_a_stop_whose_commands_then_grow_without_end() -> None:
    asked = np.where(T[:, None] > 6.0, ASKED + 40 * (T[:, None] - 6.0), ASKED)
    assert found(given((6.0, 10.0)), asked)[3050:].all()


@pytest.mark.parametrize(
    "measured",
    [
        given(),
        np.clip(given(), -0.4, 0.4),  # a limit
        0.3 * given(),  # a wrong torque constant
        np.roll(given(), 10, axis=0),  # a delay
        np.where(np.abs(ASKED) < 0.15, 0.0, given()),  # a dead band
    ],
)
def test_a_drive_that_gives_less_is_not_off(measured: np.ndarray) -> None:
    assert not found(measured).any()


def test_a_drive_of_which_nothing_is_asked_is_not_off() -> None:
    rest = np.where(T[:, None] > 6.0, 0.0, ASKED)
    assert not found(rest + RNG.normal(0, 0.02, rest.shape), rest).any()


def test_a_torque_that_comes_late_after_a_rest_is_none() -> None:
    asked = np.where(T[:, None] < 6.0, 0.0, 1.0 + ASKED)
    measured = np.roll(asked, 15, axis=0) + RNG.normal(0, 0.02, asked.shape)
    assert not found(measured, asked).any()


def test_the_stated_loop_says_what_is_asked() -> None:
    signals = {"position": 0 * ASKED, "velocity": 0 * ASKED, "torque_measured": given((6.0, 10.0))}
    signals["position_reference"] = ASKED / 40.0
    law = Controller("pd", "joint", (40.0, 40.0), (1.0, 1.0))
    good = np.ones(len(T), bool)
    assert dead_rows(signals, good, STEP, law, "joint")[3050:].all()
    assert not dead_rows(signals, good, STEP, UNKNOWN, "joint").any()


def test_a_law_of_the_wrong_sign_is_no_drive_that_is_off() -> None:
    """Positions at minus the stated reference: the law asks for far more than what moves the axis."""
    reference = np.column_stack([0.9 + 0.3 * np.sin(3 * T), 0.9 + 0.3 * np.cos(4 * T)])
    some = np.where(T > 6.0, 1.0, 0.01)[:, None]  # now and then a tenth of it, by chance
    signals = {
        "position": -reference,
        "velocity": np.gradient(-reference, STEP, axis=0),
        "position_reference": reference,
        "torque_measured": 5 * some * ASKED + RNG.normal(0, 0.02, ASKED.shape),
    }
    law = Controller("pd", "joint", (40.0, 40.0), (1.0, 1.0))
    assert not dead_rows(signals, np.ones(len(T), bool), STEP, law, "joint").any()
