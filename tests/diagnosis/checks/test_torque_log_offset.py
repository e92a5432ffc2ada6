"""A torque that was logged rows beside its command is said to be; what drives do themselves is not."""

from __future__ import annotations

import numpy as np
import pytest
from exam.degrade import degrade

from tests.diagnosis.rig import recordings
from workbench.core import Recording
from workbench.diagnosis.checks.torque_log_offset import torque_offset_lines
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

DELAY = load_model("leg").actuators.delay_s


def shifted(recording: Recording, rows: int) -> Recording:
    return recording.with_signals(torque_measured=np.roll(recording.signals["torque_measured"], rows, axis=0))


@pytest.mark.parametrize(("rows", "words"), [(1, "lags"), (3, "by 3 rows ("), (-1, "leads")])
def test_a_shifted_log_is_said_to_be_one(rows: int, words: str) -> None:
    training, _ = recordings()
    lines = torque_offset_lines([shifted(r, rows) for r in training], DELAY)
    assert [words in line for line in lines] == [True, True]
    assert ["hip" in lines[0], "knee" in lines[1]] == [True, True]


@pytest.mark.parametrize(
    "hidden",
    [
        (),
        (HiddenEffect("current_loop_lag", "knee", parameters={"time_constant": 0.002}),),
        (HiddenEffect("torque_saturation", "knee", parameters={"limit": 1.0}),),
    ],
    ids=["clean", "lag", "limit"],
)
def test_what_drives_do_is_no_shift(hidden: tuple[HiddenEffect, ...]) -> None:
    training, _ = recordings(*hidden)
    assert torque_offset_lines(training, DELAY) == []


def test_without_both_torques_nothing_is_said() -> None:
    training, _ = recordings()
    assert torque_offset_lines([degrade(r, without=("torque_measured",)) for r in training], DELAY) == []
