"""Feedback that repeats itself: found where it contradicts itself or its commands, never at rest."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.deployment.robot import HOLD, TICK, Robot
from tests.deployment.test_safety import LIMITS as SAFE
from tests.deployment.test_safety import running, seen, wanted
from workbench.can import Frame
from workbench.deployment import Host, SimulatedNetwork, Target, step
from workbench.deployment.base import BaseMotion
from workbench.deployment.network import Arrival
from workbench.rigs import PERFECT, MotorBank

LIMITS = replace(SAFE, notice=np.array([0.5, 0.25]))


def freeze(robot: Robot, drives: set[int]) -> float:
    """From now on these drives' answers have the bytes of their last; returns the time."""
    last: dict[tuple[str, int], Frame] = {}
    ids = {(robot.config.motor[k].bus, robot.config.motor[k].reply_id) for k in drives}

    def repeat(arrival: Arrival) -> list[tuple[float, Arrival]]:
        key = arrival.bus, arrival.frame.id
        if key in ids and not arrival.sent:
            arrival = arrival._replace(frame=last.setdefault(key, arrival.frame))
        return [(arrival.stamp, arrival)]

    robot.network.tamper = repeat
    return robot.network.now()


@pytest.mark.parametrize("pd", ["host", "drive"])
@pytest.mark.parametrize("drives", [{0}, {3}, {0, 1}, {0, 1, 2, 3}], ids=str)
@pytest.mark.parametrize("when", [0.0, 0.13, 0.31])
def test_frozen_feedback_of_a_robot_that_moves_damps(tmp_path: Path, drives: set[int], pd: str, when) -> None:
    robot = Robot(tmp_path, pd=pd, kp=40.0, kd=1.0).start()
    robot.run(when)
    begin = freeze(robot, drives)
    assert robot.until_damped(1.0) - begin < 0.15
    assert robot.host.state.fault in ("feedback is frozen", "a drive does not follow its torque")
    assert set(robot.host.state.axes) <= drives


class Hold:
    """Stands still, and can be told to stand elsewhere."""

    def __init__(self, n: int) -> None:
        self.reference = np.resize(HOLD, n).astype(float)

    def target(self, now: float, phase: str, position, velocity, base: BaseMotion) -> Target:
        return Target(self.reference, np.zeros(len(self.reference)), now)


def still(folder: Path, **loop: object) -> Robot:
    """A robot at rest whose sensors have no noise: drives say the same bytes for as long as it stands."""
    robot = Robot(folder, **loop)
    robot.network = SimulatedNetwork(robot.config, MotorBank(robot.config, sensors=PERFECT))
    robot.motors = list(robot.network.bank.motors.values())
    robot.controller = Hold(4)  # type: ignore[assignment]
    robot.host = Host(robot.config, robot.network, robot.controller, robot.joints)
    return robot.start()


@pytest.mark.parametrize("pd", ["host", "drive"])
def test_a_robot_at_rest_is_not_frozen(tmp_path: Path, pd: str) -> None:
    robot = still(tmp_path, pd=pd, kp=40.0, kd=1.0)
    words: list[tuple[float, ...]] = []
    robot.host.run(2.5, lambda host, _: words.append((*host.feedback.position, *host.feedback.torque)))
    assert robot.host.state.phase == "run"
    tail = np.array(words[-300:])
    assert pd == "host" or (np.ptp(tail, axis=0) == 0.0).any(), "some do say the same for a second"


def test_a_drive_that_freezes_at_rest_is_found_once_told_more(tmp_path: Path) -> None:
    robot = still(tmp_path, kp=40.0)
    robot.run(2.0)
    freeze(robot, {2})
    robot.run(1.0)
    assert robot.host.state.phase == "run", "nothing tells it from one that rests"
    robot.controller.reference = robot.controller.reference + 0.2  # type: ignore[attr-defined]
    begin = robot.network.now()
    assert robot.until_damped() - begin < 10 * TICK
    assert robot.host.state.fault == "feedback is frozen" and robot.host.state.axes == (2,)


def run(torques, reported, velocity=(0.0, 0.0)):
    """What safety says of drives that stand and report this, of what was sent, while told those torques."""
    state, now = running()
    sent: list[np.ndarray] = []
    for k, torque in enumerate([torques[0]] * 5 + list(torques)):
        now += TICK
        words = np.array(reported(sent) if k >= 5 else (np.nan, np.nan), float)
        state, _ = step(LIMITS, state, seen(now, torque=words, velocity=np.array(velocity)), wanted(torque))
        sent.append(state.torque)
    return state


def test_at_a_hard_stop_only_a_drive_that_ignores_it_is_frozen() -> None:
    swing = [(3.0 * np.sin(0.2 * k), 0.0) for k in range(200)]
    assert run(swing, lambda sent: sent[-2]).phase == "run"
    assert run(swing, lambda sent: (0.0, 0.0)).fault == "feedback is frozen"
    slow = run(swing, lambda sent: sent[-2 - len(sent) % 4])
    assert slow.phase == "run", "the same words for 12 ms are no fault, whatever it was told since"
    state = run(swing, lambda sent: (0.7, 0.0))
    assert state.fault == "feedback is frozen" and state.axes == (0,)


def test_a_drive_that_is_short_of_torque_is_not_frozen() -> None:
    swing = [(8.0 + 1.9 * np.sin(0.2 * k), 0.0) for k in range(200)]
    assert run(swing, lambda sent: (5.0, 0.0)).phase == "run", "it makes 5 N m while it is told 6 to 10"
    assert run(swing, lambda sent: (7.0, 0.0)).fault == "feedback is frozen", "it was told 6 and says 7"


@pytest.mark.parametrize(
    ("ticks", "velocity", "fault"),
    [
        (17, 0.5, "feedback is frozen"),  # 48 ms of 0.5 rad/s are 24 mrad
        (12, 0.5, None),  # 17 mrad, and an encoder may have that play
        (300, 0.09, None),  # 80 mrad, but a speed may be off by that at rest
        (70, 0.12, "feedback is frozen"),
    ],
)
def test_how_far_a_speed_must_have_moved_the_axis(ticks: int, velocity: float, fault: str | None) -> None:
    assert run([(1.0, 0.0)] * ticks, lambda sent: (1.0, 0.0), (velocity, 0.0)).fault == fault


def test_how_long_a_drive_may_make_nothing_of_its_torque() -> None:
    for ticks, fault in ((30, None), (40, "a drive does not follow its torque")):
        assert run([(3.0, 0.0)] * ticks, lambda sent: (0.1, 0.0)).fault == fault


@pytest.mark.parametrize(
    ("torque", "kd", "said", "phase"),
    [
        (1.5, 5.0, 0.0, "run"),  # told -1 to 4 N m, by what its own damping makes of 0.5 rad/s
        (-1.5, 5.0, 0.0, "run"),
        (3.0, 4.0, 0.3, "run"),  # told 1 to 5 N m: 0.3 is more than a quarter of the least
        (3.0, 4.0, 0.2, "damp"),
        (-3.0, 4.0, -0.2, "damp"),
    ],
)
def test_let_go_is_only_who_makes_less_than_it_was_surely_told(torque, kd, said, phase) -> None:
    state, now = running()
    for _ in range(100):
        now += TICK
        wish = wanted((torque, -1.0), kd=(kd, 0.0))
        wish.setpoints.velocity[:] = 0.5
        state, _ = step(LIMITS, state, seen(now, torque=np.array([said, np.nan])), wish)
    assert state.phase == phase


def test_more_than_a_quarter_of_its_limit_a_drive_need_not_make() -> None:
    swing = [(3.9 + 0.7 * np.sin(0.2 * k), 0.0) for k in range(200)]
    assert run(swing, lambda sent: (3.0, 0.0)).fault is None, "its most, while it is told more"
    low = [(1.0 + 0.7 * np.sin(0.2 * k), 0.0) for k in range(200)]
    assert run(low, lambda sent: (1.0, 0.0)).fault == "feedback is frozen"


@pytest.mark.parametrize(("kd", "phase"), [(5.0, "run"), (0.0, "damp")])
def test_what_a_drive_s_own_damping_adds_is_no_contradiction(kd: float, phase: str) -> None:
    state, now = running()
    for k in range(100):
        now += TICK
        wish = wanted((3.0 * np.sin(0.2 * k), 0.0), kd=(kd, kd))
        wish.setpoints.velocity[:] = 2.0
        state, _ = step(LIMITS, state, seen(now, torque=np.array([1.2, 0.5])), wish)
    assert state.phase == phase


def test_a_drive_that_makes_none_of_its_torque_has_let_go() -> None:
    hold = [(3.0, 0.0)] * 100
    state = run(hold, lambda sent: (0.1, 0.0))
    assert state.fault == "a drive does not follow its torque" and state.axes == (0,)
    assert run(hold, lambda sent: (1.0, 0.0)).phase == "run", "a third of it: it is short of torque"


def test_a_speed_that_moves_nothing_is_frozen() -> None:
    hold = [(1.0, 0.0)] * 100
    assert run(hold, lambda sent: (1.0, 0.0), (0.06, -0.05)).phase == "run", "an offset of its sensor"
    assert run(hold, lambda sent: (1.0, 0.0), (0.5, 0.0)).fault == "feedback is frozen"


@given(
    st.lists(st.floats(-10.0, 10.0), min_size=30, max_size=120), st.floats(0.0, 0.2), st.sampled_from([1, 2])
)
def test_what_follows_its_command_is_never_frozen(torques: list[float], offset: float, lag: int) -> None:
    state = run([(t, -0.4 * t) for t in torques], lambda sent: sent[-lag] + offset)
    assert state.fault is None


def test_drives_that_report_no_torque_are_not_judged() -> None:
    swing = [(3.0 * np.sin(0.2 * k), 0.0) for k in range(100)]
    assert run(swing, lambda sent: (np.nan, np.nan)).phase == "run"


def test_an_inertial_unit_that_repeats_itself_while_joints_move() -> None:
    state, now = running()
    for same, velocity, phase in ((0.5, 0.45, "run"), (0.09, 3.0, "run"), (0.11, 0.6, "damp")):
        now += TICK
        state, _ = step(
            LIMITS, state, seen(now, base_same=same, velocity=np.array([0.0, velocity])), wanted()
        )
        assert state.phase == phase
    assert state.fault == "the inertial unit is frozen" and state.axes == ()
