"""One run of a machine on a plant: a pilot gives joint angles, the loop commands torques, and everything is
logged.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from workbench.bundle import Policy
from workbench.core import Controller, Excitation, Recording, Timing
from workbench.rigs import Sensors

from .control import action_target, drive_torque
from .environment import STEEPEST
from .machine import POLICY_STEPS, STEP_S, Machine
from .plant import Plant, State, begin, body_frame
from .robot import IDEAL, Robot
from .situation import Array, Constants, Situation
from .task import Task

HOLD_S = 0.36  # the posture is held before anything else
_GYRO, _GRAVITY = 0.02, 0.005  # rad/s and share of g: noise of a common inertial unit

#: Force on the trunk in the world (3,) [N], at a time after the hold [s] and a pose of the trunk (7,).
Push = Callable[[float, np.ndarray], np.ndarray]


class Pilot(Protocol):
    """Interface of whatever commands the joints."""

    def target(self, since: int, now: Situation) -> Array:
        """Return joint angles from now on (1, n) [rad], so many control steps after the hold."""
        ...


class PolicyPilot:
    """A policy that performs its task.

    Args:
        policy: the network.
        task: what it sees.
        machine: what it moves.
    """

    def __init__(self, policy: Policy, task: Task, machine: Machine) -> None:
        self._policy, self._task, self._c = policy, task, Constants(machine, np, np.zeros(1))
        self._action, self._target = np.zeros((1, machine.size)), machine.posture[None].copy()

    def target(self, since: int, now: Situation) -> Array:
        """Return the joint angles of the last action."""
        if since % POLICY_STEPS == 0:
            now.action = now.last_action = self._action
            seen = np.concatenate([e.scale * e.function(now) for e in self._task.observations], -1)
            self._action = self._policy(seen)
            self._target = action_target(self._c, self._action, self._task.action_scale)
        return self._target


class Log:
    """Rows of a run, one per control step."""

    def __init__(self) -> None:
        self.rows: dict[str, list[np.ndarray]] = {}
        self.policy_from = round(HOLD_S / STEP_S)
        self.fell_s: float | None = None
        self.names: tuple[str, ...] = ()

    def add(self, **values: np.ndarray) -> None:
        """Add a row."""
        for name, value in values.items():
            self.rows.setdefault(name, []).append(np.array(value, float).ravel())

    def get(self, name: str) -> np.ndarray:
        """Return a signal since the hold (N, k)."""
        return np.array(self.rows[name])[self.policy_from :]

    def recording(self, name: str, machine: Machine, stepped: bool) -> Recording:
        """Return the run as a recording in actuator coordinates; `stepped`: simulated with the steps of the
        machine's file.
        """
        rows = {key: np.array(values) for key, values in self.rows.items()}
        if "ground_force" in rows:  # a recording has it of the row that begins, a plant of the one that ended
            rows["ground_force"] = np.vstack([rows["ground_force"][1:], rows["ground_force"][-1:]])
        logged = ("position", "velocity", "torque_command", "torque_measured", "position_reference")
        own = machine.joints if machine.floating else machine.model.axes
        return Recording(
            name=name,
            axes=tuple(own),
            coordinates="actuator",
            time=STEP_S * np.arange(len(rows["position"])),
            signals={key: rows[key] for key in logged},
            units=("rad",) * machine.size,
            controller=Controller("pd", "joint", kp=tuple(machine.kp), kd=tuple(machine.kd), period_s=STEP_S),
            excitation=Excitation("policy"),
            timing=Timing(stepped=stepped),
            rig=machine.kind,
            extra={key: rows[key] for key in rows if key.startswith(("ground_", "base_"))},
        )


def run(
    pilot: Pilot, machine: Machine, plant: Plant, seconds: float, seed: int, *,
    command: np.ndarray, goal: Callable[..., tuple[Array, Array]] | None = None,
    sensors: Sensors | None = None, robot: Robot = IDEAL, push: Push | None = None,
    tell: Callable[[float], None] = lambda done: None,
) -> Log:  # fmt: skip
    """Hold the posture for `HOLD_S`, then follow the pilot; return the log.

    Args:
        pilot: says where to go.
        machine: how its loop is closed.
        plant: what moves.
        seconds: how long, after the hold.
        seed: of all noise.
        command: of the task (1, c).
        goal: joint angles that the task asks for, to be logged; see `Task.goal`.
        sensors: of the drives; by default those of the virtual leg.
        robot: whose inertial unit, latency and drives these are.
        push: pushes on its trunk.
        tell: is told the share that is done.
    """
    generator, log, n = np.random.default_rng(seed), Log(), machine.size
    sensors, c = sensors or Sensors(), Constants(machine, np, np.zeros(1))
    log.names = machine.joints
    begin(plant, machine)
    waiting = [np.zeros((1, n))] * (machine.delay_steps + robot.latency_steps)
    target, felt = machine.posture[None].copy(), []
    ticks = log.policy_from + round(seconds / STEP_S)
    for tick in range(ticks):
        true = plant.state()
        position, velocity = _measured(true, sensors, generator)
        joints, speeds = machine.joint_motion(position, velocity)
        since = tick - log.policy_from
        if since >= 0:
            now = Situation(
                xp=np, machine=c, position=joints[None], velocity=speeds[None], torque=np.zeros((1, n)),
                action=np.zeros((1, n)), last_action=np.zeros((1, n)), elapsed=np.array([since * STEP_S]),
                command=command,
            )  # fmt: skip
            if machine.floating and since % POLICY_STEPS == 0:
                _feel(now, true, robot, felt, generator)
            target = pilot.target(since, now)
        waiting.append(drive_torque(c, target, joints[None], speeds[None]))
        asked, acting = waiting[-1], robot.delivered(waiting.pop(0)[0], true.velocity, machine.torque_limit)
        log.add(
            position=position,
            velocity=velocity,
            torque_command=asked,
            torque_measured=acting + sensors.torque_noise * generator.standard_normal(n),
            position_reference=target,
        )
        if goal is not None:
            log.add(
                goal=goal(np, command, np.array([since * STEP_S]))[0],
                joints=machine.joint_motion(true.position, true.velocity)[0],
            )
        if machine.floating:
            gravity, linear, angular = body_frame(true)
            felt = [(gravity, angular), *felt[: robot.imu_steps]]
            log.add(ground_force=true.feet, base_pose=true.pose, base_linear=linear, base_angular=angular)
            log.add(base_gravity=gravity)
            # as recordings name them: what compare and diagnose read
            log.add(base_position=true.pose[:3], base_orientation=true.pose[3:])
            log.add(base_velocity=true.rate[:3], base_angular_velocity=true.rate[3:])
            if log.fell_s is None and (true.pose[2] < machine.lowest or -gravity[0, 2] < STEEPEST):
                log.fell_s = max(since, 0) * STEP_S
                break
        if push is not None:
            plant.push(push(since * STEP_S, true.pose))
        plant.advance(acting)
        tell((tick + 1) / ticks)
    return log


def _measured(true: State, sensors: Sensors, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    position = true.position
    if sensors.encoder:
        position = sensors.encoder * np.round(position / sensors.encoder)
    return position, true.velocity + sensors.velocity_noise * generator.standard_normal(len(position))


def _feel(
    now: Situation, true: State, robot: Robot, before: list[tuple[np.ndarray, np.ndarray]],
    generator: np.random.Generator,
) -> None:  # fmt: skip
    gravity, now.linear, angular = body_frame(true)
    gravity, angular = robot.felt(gravity, angular, before)
    now.gravity = gravity + _GRAVITY * generator.standard_normal((1, 3))
    now.angular = angular + _GYRO * generator.standard_normal((1, 3))
    now.height = true.pose[2:3]
