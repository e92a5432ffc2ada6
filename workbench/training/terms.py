"""Observations and rewards as small functions of a situation; the tasks' tables are lists of them.

The functions know no weight, no scale and no noise: a table gives them. Each line of its docstring's first
sentence goes into the documentation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from .situation import Array, Situation

AIR_TIME_S = 0.25  # a step that is worth the most
CONTACT_N = 1.0  # normal force that counts as standing on a foot


@dataclass(frozen=True)
class Reward:
    """A term of the reward: `weight` per second times ``function(situation)``, (W,)."""

    name: str
    weight: float
    function: Callable[[Situation], Array]

    @property
    def about(self) -> str:
        """Return what it measures, in a sentence."""
        return _first_line(self.function)


@dataclass(frozen=True)
class Observation:
    """Numbers for the policy: ``scale * (function(situation) + noise)``, (W, k).

    `noise` is the half-width of the sensor's uniform error, in the unit of the function.
    """

    name: str
    function: Callable[[Situation], Array]
    scale: float = 1.0
    noise: float = 0.0

    @property
    def about(self) -> str:
        """Return what it is, with its unit, in a sentence."""
        return _first_line(self.function)


def _first_line(function: Callable[..., object]) -> str:
    """Return the first line of its docstring; empty where there is none."""
    return next(iter((function.__doc__ or "").strip().splitlines()), "")


def _sum2(s: Situation, x: Array) -> Array:
    return s.xp.sum(s.xp.square(x), -1)


# observations


def joint_offset(s: Situation) -> Array:
    """Joint angles, measured from the posture [rad]."""
    return s.position - s.machine.posture


def joint_velocity(s: Situation) -> Array:
    """Joint speeds [rad/s]."""
    return s.velocity


def last_action(s: Situation) -> Array:
    """The action of the preceding policy step."""
    return s.action


def base_angular(s: Situation) -> Array:
    """Angular velocity of the base in its own frame [rad/s]."""
    return s.angular


def gravity(s: Situation) -> Array:
    """Direction of gravity in the base's frame."""
    return s.gravity


def velocity_command(s: Situation) -> Array:
    """Commanded forward and sideward speed [m/s] and yaw rate [rad/s]."""
    return s.command[:, :3]


def base_linear(s: Situation) -> Array:
    """Linear velocity of the base in its own frame [m/s]."""
    return s.linear


def base_height(s: Situation) -> Array:
    """Height of the base over the ground [m]."""
    return s.height[:, None]


def foot_load(s: Situation) -> Array:
    """Normal force on each foot, in hundreds of N."""
    return 0.01 * s.foot_force


# rewards


def alive(s: Situation) -> Array:
    """1 as long as the robot has not fallen."""
    return 1.0 - s.fallen * 1.0


def fall(s: Situation) -> Array:
    """1 in the step in which it falls."""
    return s.fallen * 1.0


def torque2(s: Situation) -> Array:
    """Sum of squared drive torques [N^2 m^2]."""
    return _sum2(s, s.torque)


def action_rate2(s: Situation) -> Array:
    """Sum of squared changes of the action from step to step."""
    return _sum2(s, s.action - s.last_action)


def joint_speed2(s: Situation) -> Array:
    """Sum of squared joint speeds [rad^2/s^2]."""
    return _sum2(s, s.velocity)


def outside_limits(s: Situation) -> Array:
    """Sum of the angles by which joints are outside their limits [rad]."""
    zero = s.xp.zeros_like(s.position)
    above, below = s.position - s.machine.high, s.machine.low - s.position
    return s.xp.sum(s.xp.maximum(above, zero) + s.xp.maximum(below, zero), -1)


def off_posture2(s: Situation) -> Array:
    """Sum of squared joint angles, measured from the posture [rad^2]."""
    return _sum2(s, s.position - s.machine.posture)


def abduction2(s: Situation) -> Array:
    """Sum of squared abduction angles [rad^2]."""
    return _sum2(s, s.position[:, 0::3])


def forward_tracking(s: Situation) -> Array:
    """exp(-|v_xy - command|^2 / 0.25 m^2/s^2)."""
    return s.xp.exp(-_sum2(s, s.linear[:, :2] - s.command[:, :2]) / 0.25)


def fine_forward_tracking(s: Situation) -> Array:
    """exp(-|v_xy - command|^2 / 0.02 m^2/s^2)."""
    return s.xp.exp(-_sum2(s, s.linear[:, :2] - s.command[:, :2]) / 0.02)


def yaw_tracking(s: Situation) -> Array:
    """exp(-(yaw rate - command)^2 / 0.25 rad^2/s^2)."""
    return s.xp.exp(-s.xp.square(s.angular[:, 2] - s.command[:, 2]) / 0.25)


def vertical2(s: Situation) -> Array:
    """Squared vertical speed of the base [m^2/s^2]."""
    return s.xp.square(s.linear[:, 2])


def horizontal2(s: Situation) -> Array:
    """Squared horizontal speed of the base [m^2/s^2]."""
    return _sum2(s, s.linear[:, :2])


def roll_pitch_rate2(s: Situation) -> Array:
    """Squared roll and pitch rate [rad^2/s^2]."""
    return _sum2(s, s.angular[:, :2])


def roll_yaw_rate2(s: Situation) -> Array:
    """Squared roll and yaw rate [rad^2/s^2]."""
    return s.xp.square(s.angular[:, 0]) + s.xp.square(s.angular[:, 2])


def tilt2(s: Situation) -> Array:
    """Squared horizontal component of gravity in the base's frame."""
    return _sum2(s, s.gravity[:, :2])


def roll2(s: Situation) -> Array:
    """Squared sideward component of gravity in the base's frame."""
    return s.xp.square(s.gravity[:, 1])


def height2(s: Situation) -> Array:
    """Squared difference of the base's height from 2 cm below that of the posture [m^2]."""
    return s.xp.square(s.height - s.machine.machine.height + 0.02)


def planted(s: Situation) -> Array:
    """Share of the feet that carry load."""
    return s.xp.sum((s.foot_force > CONTACT_N) * 1.0, -1) / s.foot_force.shape[-1]


def slip2(s: Situation) -> Array:
    """Squared horizontal speed of the feet that carry load [m^2/s^2]."""
    loaded = (s.foot_force > CONTACT_N) * 1.0
    return s.xp.sum(loaded * s.xp.sum(s.xp.square(s.foot_speed[..., :2]), -1), -1)


def foot_speed2(s: Situation) -> Array:
    """Squared speed of all feet [m^2/s^2]."""
    return s.xp.sum(s.xp.sum(s.xp.square(s.foot_speed), -1), -1)


def long_steps(s: Situation) -> Array:
    """Time in the air of feet that land, at most 0.25 s, minus 0.1 s per foot [s]; zero when standing is
    commanded.
    """
    capped = s.xp.clip(s.landed, 0.0, AIR_TIME_S) - 0.1
    moving = (_sum2(s, s.command[:, :3]) > 0.01) * 1.0
    return moving * s.xp.sum(capped * (s.landed > 0.0), -1)
