"""A bundle on virtual hardware, logged as a real test would be, and in the world that it was trained in."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.bundle import Policy, PolicyBundle
from workbench.core import Controller, Excitation, InputError, Recording, Timing
from workbench.models import Model
from workbench.rigs import HiddenEffect, Sensors

from .control import action_target, drive_torque
from .draws import Draws
from .environment import STEEPEST
from .machine import POLICY_STEPS, STEP_S, Machine, make_machine
from .of_bundle import machine_of, task_of
from .own_plant import OwnPlant
from .plants import ClosedChainPlant, Plant, State, TrainedPlant, begin, body_frame
from .situation import Constants, Situation
from .task import Task

HOLD_S = 0.36  # the posture is held before the policy takes over
_GYRO, _GRAVITY = 0.02, 0.005  # rad/s and share of g: noise of a common inertial unit


@dataclass(frozen=True)
class Evaluation:
    """How a policy did.

    Attributes:
        recording: the log; rows every control step, the first `HOLD_S` seconds without the policy.
        scores: numbers of the task by name.
        fell_s: when it fell, counted from the policy's start [s]; None if it did not.
    """

    recording: Recording
    scores: dict[str, float]
    fell_s: float | None


def evaluate(
    bundle: PolicyBundle,
    *,
    seconds: float = 4.0,
    seed: int = 0,
    hardware: bool = True,
    sensors: Sensors | None = None,
    hidden: Sequence[HiddenEffect] = (),
    friction: float | None = None,
    model: Model | None = None,
    task_file: Path | None = None,
    tell: Callable[[float], None] = lambda done: None,
) -> Evaluation:
    """Run a bundle's policy.

    Args:
        bundle: the policy.
        seconds: how long, after the hold.
        seed: of the command (``reach``) and of the sensors' noise.
        hardware: on the closed chain in Drake; else in the serial machine that it was trained in.
        sensors: of the drives; by default those of the virtual leg.
        hidden: effects in the drives of the hardware's legs.
        friction: coefficient of the hardware's ground, where it has one.
        model: of a leg, with its variant; the simulation is of this model instead of the trained one.
        task_file: the Python file of a task that is one.
        tell: is told the share that is done.

    Raises:
        InputError: the bundle cannot be run here, or hardware and simulation are asked for at once.
    """
    if (hidden or friction is not None) if not hardware else model is not None:
        raise InputError(
            "effects and friction are the hardware's, a model is the simulation's",
            remedy="leave out what belongs to the other",
        )
    with tempfile.TemporaryDirectory() as folder:
        machine = machine_of(bundle, Path(folder), task_file)
        if hardware:
            ground = {} if friction is None else {"friction": friction}
            plant: Plant = (
                ClosedChainPlant(machine, hidden, **ground) if machine.floating else OwnPlant(machine, hidden)
            )
        else:
            other = None if model is None else make_machine(machine.kind, model)
            plant = TrainedPlant(other or machine)
    task = task_of(bundle, task_file)
    log = _run(Policy(bundle), task, machine, plant, seconds, seed, sensors or Sensors(), tell)
    name = f"{task.name}_{bundle.variant}_{'hardware' if hardware else 'simulation'}"
    return Evaluation(log.recording(name, machine, hardware), task.scores(log), log.fell_s)


class Log:
    """Rows of a run, a control step each."""

    def __init__(self) -> None:
        self.rows: dict[str, list[np.ndarray]] = {}
        self.policy_from = round(HOLD_S / STEP_S)
        self.fell_s: float | None = None
        self.names: tuple[str, ...] = ()

    def add(self, **values: np.ndarray) -> None:
        """A row."""
        for name, value in values.items():
            self.rows.setdefault(name, []).append(np.array(value, float).ravel())

    def get(self, name: str) -> np.ndarray:
        """A signal since the policy began (N, k)."""
        return np.array(self.rows[name])[self.policy_from :]

    def recording(self, name: str, machine: Machine, hardware: bool) -> Recording:
        """The run as a recording in actuator coordinates."""
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
            timing=Timing(stepped=machine.floating and not hardware),
            rig=machine.kind,
            extra={key: rows[key] for key in rows if key.startswith(("ground_", "base_"))},
        )


def _run(
    policy: Policy, task: Task, machine: Machine, plant: Plant, seconds: float, seed: int, sensors: Sensors,
    tell: Callable[[float], None],
) -> Log:  # fmt: skip
    generator, log, n = np.random.default_rng(seed), Log(), machine.size
    c = Constants(machine, np, np.zeros(1))
    command = _command(task, seed, machine)
    log.names = machine.joints
    begin(plant, machine)
    waiting = [np.zeros((1, n))] * machine.delay_steps
    action, target = np.zeros((1, n)), machine.posture[None].copy()
    ticks = log.policy_from + round(seconds / STEP_S)
    for tick in range(ticks):
        true = plant.state()
        position, velocity = _measured(true, sensors, generator)
        joints, speeds = machine.joint_motion(position, velocity)
        since = tick - log.policy_from
        if since >= 0 and since % POLICY_STEPS == 0:
            now = _situation(c, true, joints, speeds, action, command, since, generator)
            seen = np.concatenate([e.scale * e.function(now) for e in task.observations], -1)
            action = policy(seen)
            target = action_target(c, action, task.action_scale)
        asked = drive_torque(c, target, joints[None], speeds[None])
        waiting.append(asked)
        acting = waiting.pop(0)[0]
        log.add(
            position=position,
            velocity=velocity,
            torque_command=asked,
            torque_measured=acting + sensors.torque_noise * generator.standard_normal(n),
            position_reference=target,
        )
        if task.goal is not None:
            log.add(
                goal=task.goal(np, command, np.array([since * STEP_S]))[0],
                joints=machine.joint_motion(true.position, true.velocity)[0],
            )
        if machine.floating:
            gravity, linear, angular = body_frame(true)
            log.add(ground_force=true.feet, base_pose=true.pose, base_linear=linear, base_angular=angular)
            log.add(base_gravity=gravity)
            # as recordings name them: what compare and diagnose read
            log.add(base_position=true.pose[:3], base_orientation=true.pose[3:])
            log.add(base_velocity=true.rate[:3], base_angular_velocity=true.rate[3:])
            if log.fell_s is None and (true.pose[2] < machine.lowest or -gravity[0, 2] < STEEPEST):
                log.fell_s = max(since, 0) * STEP_S
                break
        plant.advance(acting)
        tell((tick + 1) / ticks)
    return log


def _command(task: Task, seed: int, machine: Machine) -> np.ndarray:
    if task.trial is not None:
        return task.trial(machine)
    return task.command(Draws(np, seed, np.zeros(1)), 1, machine)


def _measured(true: State, sensors: Sensors, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    position = true.position
    if sensors.encoder:
        position = sensors.encoder * np.round(position / sensors.encoder)
    return position, true.velocity + sensors.velocity_noise * generator.standard_normal(len(position))


def _situation(
    c: Constants, true: State, position: np.ndarray, velocity: np.ndarray, action: np.ndarray,
    command: np.ndarray, since: int, generator: np.random.Generator,
) -> Situation:  # fmt: skip
    now = Situation(
        xp=np, machine=c, position=position[None], velocity=velocity[None], torque=np.zeros_like(action),
        action=action, last_action=action, elapsed=np.array([since * STEP_S]), command=command,
    )  # fmt: skip
    if c.machine.floating:
        gravity, now.linear, angular = body_frame(true)
        now.gravity = gravity + _GRAVITY * generator.standard_normal((1, 3))
        now.angular = angular + _GYRO * generator.standard_normal((1, 3))
        now.height = true.pose[2:3]
    return now
