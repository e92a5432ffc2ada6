"""How a controller's answer becomes setpoints, and what becomes of one that fails."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.can.make import config, motor
from tests.deployment.robot import LIMITS, RANGES
from workbench.core import InputError
from workbench.deployment import Target, initial, joints_of
from workbench.deployment.base import BaseMotion
from workbench.deployment.feedback import Feedback
from workbench.deployment.wishes import Wishes

J = np.array([[1.0, 0.0], [1.0, 1.0]])
Q, W = np.array([0.2, 0.9]), np.array([0.5, -1.0])  # of the axes
KP, KD = 50.0, 1.5


class Clock:
    """Time that passes while a controller thinks."""

    time = 10.0

    def now(self) -> float:
        return self.time


class Says:
    """A controller that says one thing, after a while."""

    def __init__(self, clock: Clock, answer, takes: float = 0.0) -> None:
        self.clock, self.answer, self.takes = clock, answer, takes
        self.asked: list[tuple] = []

    def target(self, now: float, phase: str, position, velocity, base: BaseMotion) -> Target | None:
        self.asked.append((now, phase, position, velocity))
        self.clock.time += self.takes
        if isinstance(self.answer, BaseException):
            raise self.answer
        return self.answer


def wishes(folder: Path, answer, takes: float = 0.0, pd: str = "host", soft_start_s: float = 0.4):
    motors = [motor(axis, k + 1, limits=LIMITS, ranges=RANGES) for k, axis in enumerate(("hip", "knee"))]
    stated = {"axes": ["hip", "knee"], "transmission": J.tolist(), "limits": [[-1.6, 1.6], [0.35, 2.6]]}
    robot = config(folder, motors, mechanism=[stated], loop={"kp": KP, "kd": KD, "pd": pd})
    clock, feedback = Clock(), Feedback(robot)
    feedback.position[:], feedback.velocity[:] = Q, W
    says = Says(clock, answer, takes)
    return Wishes(robot, clock, says, joints_of(robot), soft_start_s), says, feedback  # type: ignore[arg-type]


def state(phase: str, since: float = 0.0):
    return replace(initial(2), phase=phase, since=since)


def target(reference=(0.3, 0.8), feedforward=(0.0, 0.0), made: float = 10.0) -> Target:
    return Target(np.array(reference), np.array(feedforward), made)


@pytest.mark.parametrize("phase", ["off", "damp"])
def test_nobody_is_asked_while_nothing_is_to_move(tmp_path: Path, phase: str) -> None:
    wish, says, feedback = wishes(tmp_path, target())
    assert wish.ask(10.0, state(phase), feedback) == (None, None) and not says.asked


def test_the_host_closes_the_loop_of_the_joints(tmp_path: Path) -> None:
    wish, says, feedback = wishes(tmp_path, target(feedforward=(0.7, -0.3)))
    wanted, failed = wish.ask(9.9, state("run"), feedback)
    assert wanted is not None and failed is None
    position, velocity = np.linalg.solve(J, Q), np.linalg.solve(J, W)
    assert says.asked[0][:2] == (9.9, "run")
    assert says.asked[0][2] == pytest.approx(position) and says.asked[0][3] == pytest.approx(velocity)
    tau = KP * (np.array([0.3, 0.8]) - position) - KD * velocity
    assert wanted.setpoints.torque == pytest.approx(np.linalg.solve(J.T, tau) + np.array([0.7, -0.3]))
    assert wanted.setpoints.position == pytest.approx(Q)
    assert not wanted.setpoints.kp.any() and not wanted.setpoints.kd.any()
    assert not wanted.setpoints.velocity.any()


def test_the_drives_close_loops_of_their_own(tmp_path: Path) -> None:
    wish, _, feedback = wishes(tmp_path, target(feedforward=(0.7, -0.3)), pd="drive")
    wanted, _ = wish.ask(10.0, state("run"), feedback)
    assert wanted is not None and wanted.setpoints.torque == pytest.approx([0.7, -0.3])
    assert wanted.setpoints.position == pytest.approx(J @ [0.3, 0.8])
    assert wanted.setpoints.kp == pytest.approx([KP, KP]) and wanted.setpoints.kd == pytest.approx([KD, KD])
    assert not wanted.setpoints.velocity.any()


def test_references_are_held_to_limits_and_insane_ones_told(tmp_path: Path) -> None:
    for reference, expected in (((2.0, 0.1), (1.6, 0.35)), ((1e3, 0.8), None), ((np.nan, 0.8), None)):
        wish, _, feedback = wishes(tmp_path, target(reference), pd="drive")
        wanted, _ = wish.ask(10.0, state("run"), feedback)
        assert wanted is not None
        if expected is None:
            assert np.isnan(wanted.setpoints.position).any(), "which safety damps"
        else:
            assert wanted.setpoints.position == pytest.approx(J @ expected)


@pytest.mark.parametrize("soft_start_s", [0.0, 0.4])
def test_references_fade_in_from_where_the_joints_were(tmp_path: Path, soft_start_s: float) -> None:
    wish, _, feedback = wishes(tmp_path, target(), pd="drive", soft_start_s=soft_start_s)
    start, goal = np.linalg.solve(J, Q), np.array([0.3, 0.8])

    def wanted(phase: str, since: float) -> np.ndarray:
        got, _ = wish.ask(10.0, state(phase, since), feedback)
        assert got is not None
        return np.linalg.solve(J, got.setpoints.position)

    assert wanted("arm", 0.0) == pytest.approx(start if soft_start_s else goal)
    feedback.position[:] = Q + 0.1  # it has moved since: the start stays where it was
    for part in (0.0, 0.25, 0.5, 1.0, 2.0):
        there = min(part, 1.0) if soft_start_s else 1.0
        assert wanted("soft_start", 10.0 - part * 0.4) == pytest.approx(start + there * (goal - start))
    assert wanted("run", 9.9) == pytest.approx(goal)


def test_an_answer_is_as_old_as_what_it_was_made_of_or_took(tmp_path: Path) -> None:
    for made, takes, age in ((10.0, 0.0, 0.0), (9.97, 0.0, 0.03), (9.97, 0.05, 0.05), (9.97, 0.01, 0.03)):
        wish, _, feedback = wishes(tmp_path, target(made=made), takes)
        wanted, _ = wish.ask(10.0, state("run"), feedback)
        assert wanted is not None and wanted.age == pytest.approx(age)


def test_no_answer_is_none_and_no_failure(tmp_path: Path) -> None:
    wish, _, feedback = wishes(tmp_path, None)
    assert wish.ask(10.0, state("run"), feedback) == (None, None)


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (InputError("no trajectory", remedy="give one"), "the controller failed: no trajectory"),
        (ValueError("bad\n  shape"), "the controller failed: ValueError: bad shape"),
        (ZeroDivisionError(), "the controller failed: ZeroDivisionError: "),
    ],
)
def test_whatever_it_raises_is_told_in_one_line(tmp_path: Path, error: Exception, said: str) -> None:
    wish, _, feedback = wishes(tmp_path, error)
    wanted, failed = wish.ask(10.0, state("run"), feedback)
    assert wanted is None and failed is not None and failed.startswith(said) and "\n" not in failed


@pytest.mark.parametrize("end", [KeyboardInterrupt(), SystemExit(3)])
def test_what_is_to_end_the_program_goes_further_up(tmp_path: Path, end: BaseException) -> None:
    wish, _, feedback = wishes(tmp_path, end)
    with pytest.raises(type(end)):
        wish.ask(10.0, state("run"), feedback)
