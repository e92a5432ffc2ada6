"""What goes wrong on a bus, in simulated time, and how fast everything damps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.deployment.robot import TICK, Robot
from workbench.can import Feedback as Said
from workbench.can import Frame, Setpoint
from workbench.deployment.network import Arrival


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
