"""The shipped tasks: commands, observations, rewards."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from . import terms as t
from .draws import Draws
from .judging import circular_scores, pitch_scores, reach_scores
from .machine import Machine
from .situation import POLICY_S, Array, Situation
from .task import Task
from .terms import Observation, Reward

PITCH_HZ, PITCH_RAD = 5.0, 0.1  # paper, Sec. V: sinusoidal base-pitch command
CIRCLE = 0.8, 0.0, 0.8  # paper, Table V: 0.8 m/s, 0.8 rad/s
VELOCITIES = (-0.6, 1.2), (-0.3, 0.3), (-1.0, 1.0)  # forward, sideward [m/s], turning [rad/s]
REACH_AHEAD = 1, 2, 4  # policy steps that the reference is seen ahead
# of the way from the posture to a limit: where the middle of a trajectory lies, and its amplitude at most
_REACH_MIDDLE, _REACH_SIZE = 0.19, 0.72
_REACH_MOST = 0.5  # rad


# reach


def reach_reference(xp: Any, command: Array, time: Array) -> tuple[Array, Array]:
    """Return joint angles and speeds to follow, (W, n) each [rad, rad/s].

    One sine per joint around its centre: `command` has centre, amplitude, frequency [rad/s] and phase, n
    numbers each.
    """
    n = command.shape[1] // 4
    middle, size, rate, phase = (command[:, k * n : (k + 1) * n] for k in range(4))
    angle = rate * time[:, None] + phase
    return middle + size * xp.sin(angle), size * rate * xp.cos(angle)


def reach_command(draws: Draws, worlds: int, machine: Machine) -> Array:
    """Return trajectories around the posture of the machine, inside its limits, up to 1.5 Hz and 5 rad/s."""
    below = machine.posture - machine.limits[:, 0]
    above = machine.limits[:, 1] - machine.posture
    size = np.minimum(_REACH_MOST, _REACH_SIZE * np.minimum(below, above))
    ones = np.ones(machine.size)
    low = [machine.posture - _REACH_MIDDLE * below, 0.2 * size, 1.5 * ones, 0.0 * ones]
    high = [machine.posture + _REACH_MIDDLE * above, size, 9.4 * ones, 2 * math.pi * ones]
    flat = [tuple(map(float, np.concatenate(parts))) for parts in (low, high)]
    return draws.uniform(flat[0], flat[1], (worlds, 4 * machine.size))


def _reach_error2(s: Situation) -> Array:
    wanted, _ = reach_reference(s.xp, s.command, s.elapsed)
    return s.xp.sum(s.xp.square(s.position - wanted), -1)


def reach_tracking(s: Situation) -> Array:
    """exp(-|joint angles - reference|^2 / 0.05 rad^2)."""
    return s.xp.exp(-_reach_error2(s) / 0.05)


def reach_fine_tracking(s: Situation) -> Array:
    """exp(-|joint angles - reference|^2 / 0.002 rad^2)."""
    return s.xp.exp(-_reach_error2(s) / 0.002)


def reach_error(s: Situation) -> Array:
    """Joint angles minus the reference [rad]."""
    return s.position - reach_reference(s.xp, s.command, s.elapsed)[0]


def reach_ahead(s: Situation) -> Array:
    """Reference 0, 1, 2 and 4 policy steps ahead, measured from the posture [rad]."""
    ahead = [
        reach_reference(s.xp, s.command, s.elapsed + k * POLICY_S)[0] - s.machine.posture
        for k in (0, *REACH_AHEAD)
    ]
    return s.xp.concatenate(ahead, -1)


def reach_speed(s: Situation) -> Array:
    """Speed of the reference [rad/s]."""
    return reach_reference(s.xp, s.command, s.elapsed)[1]


REACH = Task(
    name="reach",
    about="One leg follows trajectories in its joints.",
    machine="leg",
    episode_s=4.0,
    action_scale=0.5,
    observations=(
        Observation("joint_offset", t.joint_offset, noise=0.002),
        Observation("joint_velocity", t.joint_velocity, 0.1, noise=0.1),
        Observation("reach_error", reach_error, 2.0, noise=0.002),
        Observation("reach_ahead", reach_ahead),
        Observation("reach_speed", reach_speed, 0.1),
        Observation("last_action", t.last_action),
    ),
    privileged=(),
    rewards=(
        Reward("reach_tracking", 1.0, reach_tracking),
        Reward("reach_fine_tracking", 1.0, reach_fine_tracking),
        Reward("action_rate2", -0.02, t.action_rate2),
        Reward("torque2", -2e-4, t.torque2),
        Reward("outside_limits", -1.0, t.outside_limits),
    ),
    command=reach_command,
    numbers=lambda joints: 4 * joints,
    goal=reach_reference,
    scores=reach_scores,
    randomisation="none",
    hidden=(64, 64),
    iterations=200,
)


# pitch in place


def pitch_reference(s: Situation) -> tuple[Array, Array]:
    """Return the commanded base pitch and pitch rate, (W,) each [rad, rad/s]."""
    rate = 2.0 * math.pi * PITCH_HZ
    angle = rate * s.elapsed + s.command[:, 0]
    return PITCH_RAD * s.xp.sin(angle), PITCH_RAD * rate * s.xp.cos(angle)


def pitch_command(draws: Draws, worlds: int, machine: Machine) -> Array:
    """Return the phase at the start of an episode [rad]."""
    return draws.uniform((0.0,), (2.0 * math.pi,), (worlds, 1))


def pitch_phase(s: Situation) -> Array:
    """Sine and cosine of the commanded oscillation's phase."""
    wanted, rate = pitch_reference(s)
    peak = 2.0 * math.pi * PITCH_HZ * PITCH_RAD
    return s.xp.stack([wanted / PITCH_RAD, rate / peak], -1)


def pitch_tracking(s: Situation) -> Array:
    """exp(-(pitch - command)^2 / (0.05 rad)^2)."""
    return s.xp.exp(-s.xp.square((s.pitch - pitch_reference(s)[0]) / 0.05))


def pitch_rate_tracking(s: Situation) -> Array:
    """exp(-(pitch rate - command)^2 / (1.5 rad/s)^2)."""
    return s.xp.exp(-s.xp.square((s.angular[:, 1] - pitch_reference(s)[1]) / 1.5))


_ROBOT_SEES = (
    Observation("base_angular", t.base_angular, 0.25, noise=0.1),
    Observation("gravity", t.gravity, noise=0.02),
    Observation("joint_offset", t.joint_offset, noise=0.005),
    Observation("joint_velocity", t.joint_velocity, 0.1, noise=0.3),
    Observation("last_action", t.last_action),
)
_CRITIC_SEES = (
    Observation("base_linear", t.base_linear),
    Observation("base_height", t.base_height),
    Observation("foot_load", t.foot_load),
)

PITCH = Task(
    name="pitch-in-place",
    about="The trunk pitches at 5 Hz, 0.1 rad, with all feet planted.",
    machine="quadruped",
    episode_s=6.0,
    action_scale=0.3,
    observations=(*_ROBOT_SEES, Observation("pitch_phase", pitch_phase)),
    privileged=_CRITIC_SEES,
    rewards=(
        Reward("pitch_tracking", 2.0, pitch_tracking),
        Reward("pitch_rate_tracking", 2.0, pitch_rate_tracking),
        Reward("planted", 6.0, t.planted),
        Reward("alive", 1.0, t.alive),
        Reward("fall", -100.0, t.fall),
        Reward("slip2", -0.2, t.slip2),
        Reward("foot_speed2", -0.05, t.foot_speed2),
        Reward("horizontal2", -1.0, t.horizontal2),
        Reward("roll_yaw_rate2", -0.05, t.roll_yaw_rate2),
        Reward("roll2", -3.0, t.roll2),
        Reward("height2", -10.0, t.height2),
        Reward("abduction2", -0.5, t.abduction2),
        Reward("torque2", -5e-5, t.torque2),
        Reward("action_rate2", -0.005, t.action_rate2),
        Reward("outside_limits", -1.0, t.outside_limits),
    ),
    command=pitch_command,
    trial=lambda machine: np.zeros((1, 1)),
    scores=pitch_scores,
    randomisation="none",
    hidden=(256, 128, 64),
    iterations=1500,
)


# circular locomotion


def circular_command(draws: Draws, worlds: int, machine: Machine) -> Array:
    """Return forward and sideward speed and yaw rate; one world in ten stands, two in ten run the circle."""
    low, high = zip(*VELOCITIES, strict=True)
    drawn = draws.uniform(low, high, (worlds, 3))
    kind = draws.uniform((0.0,), (1.0,), (worlds, 1))
    circle = draws.constant(CIRCLE, (worlds, 3))
    xp = draws.xp
    return xp.where(kind < 0.1, xp.zeros_like(drawn), xp.where(kind < 0.3, circle, drawn))


CIRCULAR = Task(
    name="circular",
    about="The robot runs at commanded velocities; the test is a circle at 0.8 m/s and 0.8 rad/s.",
    machine="quadruped",
    episode_s=10.0,
    action_scale=0.3,
    observations=(*_ROBOT_SEES, Observation("velocity_command", t.velocity_command)),
    privileged=_CRITIC_SEES,
    rewards=(
        Reward("forward_tracking", 1.5, t.forward_tracking),
        Reward("fine_forward_tracking", 0.5, t.fine_forward_tracking),
        Reward("yaw_tracking", 1.0, t.yaw_tracking),
        Reward("alive", 0.3, t.alive),
        Reward("fall", -50.0, t.fall),
        Reward("long_steps", 10.0, t.long_steps),
        Reward("vertical2", -2.0, t.vertical2),
        Reward("roll_pitch_rate2", -0.05, t.roll_pitch_rate2),
        Reward("tilt2", -3.0, t.tilt2),
        Reward("height2", -20.0, t.height2),
        Reward("slip2", -0.1, t.slip2),
        Reward("off_posture2", -0.05, t.off_posture2),
        Reward("abduction2", -0.5, t.abduction2),
        Reward("torque2", -1e-4, t.torque2),
        Reward("joint_speed2", -2e-4, t.joint_speed2),
        Reward("action_rate2", -0.01, t.action_rate2),
        Reward("outside_limits", -2.0, t.outside_limits),
    ),
    command=circular_command,
    numbers=lambda joints: 3,
    trial=lambda machine: np.array([CIRCLE]),
    scores=lambda log: circular_scores(log, CIRCLE),
    randomisation="leg_rand",
    hidden=(256, 128, 64),
    iterations=4000,
    commands=VELOCITIES,
)

TASKS: dict[str, Task] = {task.name: task for task in (REACH, PITCH, CIRCULAR)}
