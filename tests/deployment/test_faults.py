"""What goes wrong on a robot, in simulated time, and how fast everything damps."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from tests.deployment.robot import TICK, Robot
from workbench.can import Feedback as Said
from workbench.can import Frame, Setpoint
from workbench.core import SimulationError
from workbench.deployment import Feedback, Target, VerifyError
from workbench.deployment.network import Arrival
from workbench.rigs import VirtualMotor


@pytest.fixture
def robot(tmp_path: Path) -> Robot:
    return Robot(tmp_path).start()


def test_it_runs(robot: Robot) -> None:
    robot.run(0.5)
    assert robot.host.state.phase == "run" and robot.host.punctuality.counts["garbage"] == 0
    joints = robot.joints.position(robot.host.feedback.position)
    reference = robot.controller.target(robot.network.now(), "run", joints, joints, None).reference
    assert np.abs(joints - reference).max() < 0.15, "gravity and lag of a soft loop, no more"
    assert max(motor.longest for motor in robot.motors) < 2 * TICK


# Bus-off, full transmit queue.


def test_bus_off_damps_the_others_and_replays_nothing(robot: Robot) -> None:
    wire, host = robot.network.wires["can0"], robot.network.hosts["can0"]
    off: list[float] = []
    robot.network.every_row = lambda now: off.append(now) if host.off and not off else None
    wire.damaged = lambda node, frame: node is host
    damped = robot.until_damped()
    assert off and damped - off[0] <= 2 * TICK
    robot.run(0.03)
    assert robot.damps(2) and robot.damps(3), "the other bus"
    assert not robot.motors[0].enabled and robot.motors[0].longest <= 0.020 + 3 * robot.network.bank.row
    assert not host.queue, "what was queued is forgotten"
    wire.damaged = None
    robot.run(0.1)
    assert host.off and robot.host.state.phase == "damp", "it does not come back by itself"
    robot.arm()
    assert robot.host.state.phase == "run" and all(motor.enabled for motor in robot.motors)


def test_a_full_queue_damps_and_is_flushed(robot: Robot) -> None:
    network = robot.network
    babbler = network.wires["can0"].attach("babbler", lambda stamp, frame: None)
    flood = Frame(0, bytes(8))

    def keep_talking(now: float) -> None:
        while len(babbler.queue) < 8:
            network.wires["can0"].send(babbler, flood, now)

    network.every_row = keep_talking
    begin = network.now()
    assert robot.until_damped() - begin <= 0.009 + TICK
    robot.run(0.03)
    assert robot.damps(2) and robot.damps(3)
    host = network.hosts["can0"]
    waiting = [robot.motors[0].drive.asked(f) or robot.motors[1].drive.asked(f) for _, f in host.queue]
    assert all(isinstance(s, Setpoint) and s.kp == 0 and abs(s.torque) < 0.01 for s in waiting)


def test_a_queue_that_is_full_at_once_damps_in_two_ticks(robot: Robot) -> None:
    wire, host = robot.network.wires["can1"], robot.network.hosts["can1"]
    takes = wire.send
    wire.send = lambda node, frame, now: node is not host and takes(node, frame, now)
    begin = robot.network.now()
    assert robot.until_damped() - begin <= 2 * TICK
    assert robot.host.state.fault == "bus off or queue full"


# Lost frames.


@pytest.mark.parametrize("percent", [1, 5, 20])
def test_lost_frames_are_counted_and_never_held_for_long(tmp_path: Path, percent: int) -> None:
    robot = Robot(tmp_path).start()
    generator = np.random.default_rng(percent)
    for wire in robot.network.wires.values():
        wire.lost = lambda node, frame: generator.random() < percent / 100
    oldest: list[float] = []

    def look(host, tick) -> bool:
        if host.state.phase == "run":
            oldest.append(host.feedback.age(host.state.time).max())
        return host.state.phase == "damp"

    robot.host.run(2.0, look)
    assert max(oldest) < 0.009
    assert robot.host.punctuality.again > 0
    if percent == 1:
        assert robot.host.state.phase == "run", "one frame in a hundred is nothing"
    if robot.host.state.phase == "damp":
        assert robot.host.state.fault == "no feedback for 9 ms"


@pytest.mark.parametrize(("ticks", "phase"), [(1, "run"), (3, "damp")])
def test_one_silent_tick_is_held_and_the_third_damps(robot: Robot, ticks: int, phase: str) -> None:
    begin = robot.network.now()
    silent = robot.motors[1].drive.reply_id
    robot.network.wires["can0"].lost = lambda node, frame: (
        frame.id == silent and node.name == "host" and robot.network.now() < begin + (ticks + 1) * TICK
    )
    last = robot.host.feedback.stamp[1]
    robot.run(0.03)
    assert robot.host.state.phase == phase
    if phase == "damp":
        assert robot.host.state.since - last <= 0.009 + 1e-9


# Late, reordered, repeated.


def test_late_frames_are_stale_by_their_stamp(robot: Robot) -> None:
    last = robot.network.now()
    robot.network.tamper = lambda a: [(a.stamp + 0.012, a)]
    damped = robot.until_damped()
    assert damped - last <= 0.009 + 1e-9
    robot.run(0.05)
    assert robot.host.feedback.counts["old"] > 0 and robot.host.state.phase == "damp"


def test_feedback_from_the_future_changes_nothing(robot: Robot) -> None:
    arrivals = []
    robot.network.tamper = lambda a: (arrivals.append(a), [(a.stamp, a)])[1]
    robot.run(0.01)
    feedback, now = robot.host.feedback, robot.network.now() + 0.001
    before, old = known(robot), feedback.counts["old"]
    feedback.take(arrivals[-1]._replace(stamp=now + 0.01), now)
    assert feedback.counts["old"] == old + 1
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(before, known(robot), strict=True))
    feedback.take(arrivals[-1]._replace(stamp=now), now)
    assert feedback.counts["old"] == old + 1, "the same is taken when its time has come"


def test_frames_repeated_and_out_of_order_change_nothing(robot: Robot) -> None:
    robot.network.tamper = lambda a: [(a.stamp, a), (a.stamp, a), (a.stamp + 0.004, a)]
    before = robot.host.feedback.counts["feedback"]
    robot.run(0.3)
    counts = robot.host.feedback.counts
    assert robot.host.state.phase == "run" and counts["garbage"] == 0
    assert counts["old"] >= 2 * (counts["feedback"] - before) - 20
    assert counts["feedback"] - before == pytest.approx(4 * 100, abs=8)


# Garbage.


def known(robot: Robot) -> tuple:
    f = robot.host.feedback
    return tuple(np.array(a) for a in (f.position, f.velocity, f.torque, f.temperature, f.stamp, f.faulty))


def test_a_million_random_frames_change_nothing(robot: Robot) -> None:
    feedback, now = robot.host.feedback, robot.network.now() + 1e-4
    before, generator, count = known(robot), np.random.default_rng(7), 1_000_000
    ids = generator.integers(0, 0x800, count)
    own = generator.random(count) < 0.01  # more of them with a drive's own identifier than chance has
    ids[own] = generator.integers(0x10, 0x14, own.sum())
    data, lengths = generator.bytes(8 * count), generator.integers(0, 9, count)
    held = 0
    for k, (id, length) in enumerate(zip(ids.tolist(), lengths.tolist(), strict=True)):
        frame = Frame(id, data[8 * k : 8 * k + length])
        heard = feedback.counts["feedback"]
        feedback.take(Arrival("can0" if k % 2 else "can1", now, frame), now)
        held += feedback.counts["feedback"] != heard
    assert held == 0 and feedback.counts["garbage"] > 1000 and feedback.counts["unknown"] > 900_000
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(before, known(robot), strict=True))


def test_an_impossible_step_is_rejected(robot: Robot) -> None:
    feedback, drive, now = robot.host.feedback, robot.motors[0].drive, robot.network.now() + 1e-4
    before = known(robot)
    jump = drive.answer(Said(feedback.position[0] + 1.0, 0.0, 0.0, 25.0, True))
    feedback.take(Arrival("can0", now, jump), now)
    assert feedback.counts["garbage"] == 1
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(before, known(robot), strict=True))


def test_garbage_on_the_bus_does_not_stop_the_robot(robot: Robot) -> None:
    generator = np.random.default_rng(3)
    node = robot.network.wires["can0"].attach("noise", lambda stamp, frame: None)

    def noise(now: float) -> None:
        length = int(generator.integers(0, 8))
        frame = Frame(int(generator.integers(0x10, 0x7FF)), generator.bytes(length))
        robot.network.wires["can0"].send(node, frame, now)

    robot.network.every_row = noise
    robot.run(0.5)
    assert robot.host.state.phase == "run" and robot.host.feedback.counts["unknown"] > 1000


# A dead node.


@pytest.mark.parametrize("part", [0.0, 0.17, 0.34, 0.51, 0.68, 0.85])
def test_a_dead_node_damps_the_whole_robot(robot: Robot, part: float) -> None:
    robot.network.sleep_until(robot.network.now())
    begin = robot.network.now() + TICK + part * TICK
    row = robot.network.bank.row

    def die(now: float) -> None:
        if now >= begin:
            robot.motors[3].dead = True

    robot.network.every_row = die
    damped = robot.until_damped()
    assert damped - begin <= 0.009 + row
    robot.run(2 * TICK)
    assert all(robot.damps(k) for k in range(3))


# Actions and observations that are no numbers; a policy that is late.


@pytest.mark.parametrize("spoil", [math.nan, math.inf, -math.inf, 1e9, 60.0])
def test_a_bad_action_damps_in_the_same_tick_and_is_never_sent(robot: Robot, spoil: float) -> None:
    told: list[Setpoint] = []

    def spy(frame: Frame, motor: VirtualMotor, hear: Callable[[Frame], None]) -> None:
        asked = motor.drive.asked(frame)
        if isinstance(asked, Setpoint):
            told.append(asked)
        hear(frame)

    for motor in robot.motors:
        motor.hear = partial(spy, motor=motor, hear=motor.hear)
    robot.controller.spoil = spoil
    robot.run(TICK)
    assert robot.host.state.phase == "damp"
    robot.run(0.02)
    assert told and all(math.isfinite(x) for s in told for x in s)
    assert max(abs(s.torque) for s in told) <= 24.01 and all(robot.damps(k) for k in range(4))


def test_an_observation_that_is_no_number_damps(robot: Robot) -> None:
    robot.host.feedback.position[2] = math.nan
    robot.host._compute()
    assert robot.host.state.phase == "damp"


def test_a_policy_that_is_late_damps(robot: Robot) -> None:
    robot.controller.stuck = robot.network.now()
    damped = robot.until_damped()
    assert 0.036 < damped - robot.controller.stuck <= 0.036 + TICK
    assert robot.host.state.fault == "the policy is late"


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ZeroDivisionError("no\nmass"), "ZeroDivisionError: no mass"),
        (SimulationError("the network gives no number"), "the network gives no number"),
    ],
)
def test_a_controller_that_fails_damps_and_says_with_what(robot: Robot, error: Exception, said: str) -> None:
    swings = robot.controller.target

    def fails(*args: object) -> Target:
        raise error

    robot.controller.target = fails
    begin = robot.network.now()
    assert robot.until_damped() - begin <= 2 * TICK
    assert robot.host.state.fault == f"the controller failed: {said}"
    robot.controller.target = swings
    robot.run(0.05)
    assert robot.host.state.fault == f"the controller failed: {said}", "it latches"
    robot.arm()
    assert robot.host.state.phase == "run"


def test_a_controller_that_fails_while_arming_is_not_waited_for(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.host.verify()
    robot.controller.target = lambda *args: math.sqrt(-1.0)
    robot.arm()
    assert robot.host.state.phase == "damp" and "math domain error" in str(robot.host.state.fault)


# The host is gone.


def test_drives_stop_by_themselves_when_the_host_is_gone(robot: Robot) -> None:
    robot.network.sleep_until(robot.network.now() + 0.5)
    for motor in robot.motors:
        assert not motor.enabled and motor.longest <= 0.020 + 2 * robot.network.bank.row
    robot.run(0.1)
    assert robot.host.state.phase == "damp" and not any(motor.enabled for motor in robot.motors)


def test_no_wall_clock_decides_anything(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def jumps() -> float:
        jumps.hours = -jumps.hours  # type: ignore[attr-defined]
        return 3600.0 * jumps.hours  # type: ignore[attr-defined]

    jumps.hours = 1  # type: ignore[attr-defined]
    monkeypatch.setattr(time, "time", jumps)
    robot = Robot(tmp_path).start()
    robot.run(0.3)
    assert robot.host.state.phase == "run"


def test_a_loop_that_was_held_up_damps_looks_and_goes_on(robot: Robot) -> None:
    told: list[Setpoint] = []
    hear = robot.motors[0].hear

    def spy(frame: Frame) -> None:
        asked = robot.motors[0].drive.asked(frame)
        if isinstance(asked, Setpoint):
            told.append(asked)
        hear(frame)

    robot.motors[0].hear = spy
    for _ in range(3):
        told.clear()
        robot.network.sleep_until(robot.network.now() + 0.011)
        robot.run(0.03)
        assert abs(told[0].torque) < 0.01 and told[0].kd == pytest.approx(1.0, abs=1e-3), (
            "nothing old is sent"
        )
        assert robot.host.state.phase == "run" and abs(told[-1].torque) > 0.1
    assert robot.host.punctuality.stalls == 3


def test_what_waits_is_read_before_the_loop_judges(robot: Robot) -> None:
    host, network = robot.host, robot.network
    network.sleep_until(network.now() + 0.0025)
    host._send(host._frames)
    network.sleep_until(network.now() + 0.0075)  # held up, with answers in the socket
    assert host.feedback.age(network.now()).min() > 0.009
    host.tick(network.now())
    assert host.state.phase == "run" and host.punctuality.stalls == 0


# The emergency stop.


def test_a_released_emergency_stop_moves_nothing(robot: Robot) -> None:
    robot.host.operator.stop = True
    robot.run(TICK)
    assert robot.host.state.phase == "damp"
    robot.host.operator.stop = False
    robot.run(0.3)
    assert robot.host.state.phase == "damp" and all(robot.damps(k) for k in range(4))
    robot.arm()
    assert robot.host.state.phase == "run"


# Drives that are not what the configuration says.


@pytest.mark.parametrize(
    ("parameter", "value", "said"),
    [("mode", 2.0, "is in mode 2"), ("torque", 10.0, "torque range is 10"),
     ("velocity", 30.0, "velocity range")],
)  # fmt: skip
def test_a_drive_that_is_not_as_configured_is_refused(tmp_path, parameter, value, said) -> None:
    robot = Robot(tmp_path)
    robot.motors[2].parameters[parameter] = value
    with pytest.raises(VerifyError, match=said):
        robot.host.verify()
    robot.host.operator.arm = True
    robot.run(0.1)
    assert robot.host.state.phase == "off" and not any(motor.enabled for motor in robot.motors)


def test_a_watchdog_that_cannot_be_set_is_refused(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.motors[1].parameters = Stubborn(robot.motors[1].parameters)
    with pytest.raises(VerifyError, match="watchdog"):
        robot.host.verify()


class Stubborn(dict):
    def __setitem__(self, key: str, value: float) -> None:
        pass


def test_a_silent_drive_is_refused(tmp_path: Path) -> None:
    robot = Robot(tmp_path)
    robot.motors[0].dead = True
    with pytest.raises(VerifyError, match="does not answer"):
        robot.host.verify()


def test_limits_hold_for_the_drives_own_loop_too(tmp_path: Path) -> None:
    robot = Robot(tmp_path, pd="drive", kp=40.0, kd=1.0).start()
    robot.run(0.3)
    assert robot.host.state.phase == "run" and robot.setpoint(0).kp == pytest.approx(40.0, abs=0.1)


def test_feedback_starts_unknown(tmp_path: Path) -> None:
    feedback = Feedback(Robot(tmp_path).config)
    assert np.isnan(feedback.position).all() and np.isinf(feedback.age(0.0)).all() and feedback.faulty.all()
