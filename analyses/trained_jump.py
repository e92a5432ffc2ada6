"""Jumps: the trunk follows a height over time, with all feet in the air at its top; the test is 0.50 m.

    workbench train analyses/trained_jump.py --variant s3n_full --unverified -o runs/jump

A policy feels neither its height nor its vertical speed. How high it gets is decided on its feet, by what the
legs weigh and what turns with their drives. Policies carry the text of this file: whoever changes it trains
them again.
"""

import math
from dataclasses import replace

import numpy as np

from workbench.training import terms as t
from workbench.training.machine import STEP_S
from workbench.training.situation import POLICY_S
from workbench.training.tasks import PITCH
from workbench.training.terms import CONTACT_N, Observation, Reward

PERIOD_S, APEX = 1.44, 0.5  # of a jump [s]; of the test [m]
LOW, HIGH = 0.45, 0.55  # apex [m]
STANDS, CROUCHED, OFF = 0.364, 0.28, 0.394  # height of the trunk [m]
BEND_S, PUSH_AT_S, RISE_S = 0.3, 0.36, 0.25
AHEAD = 0, 2, 4, 8  # policy steps that the reference is seen ahead
_G = 9.81


def reference(xp, apex, time):
    """Height [m] and speed [m/s] of the trunk, and whether it flies, (W,) each; a period is a jump."""
    at = time - PERIOD_S * xp.floor(time / PERIOD_S)
    speed, way = xp.sqrt(2.0 * _G * (apex - OFF)), OFF - CROUCHED
    pushes, flies, gain = 2.0 * way / speed, 2.0 * speed / _G, 0.5 * speed * speed / way
    push = at - PUSH_AT_S
    fly, land = push - pushes, push - pushes - flies
    rise = land - pushes
    deep, back = _smooth(xp, at / BEND_S), _smooth(xp, rise / RISE_S)
    low = STANDS - CROUCHED
    height, rate = STANDS - low * deep[0], -low * deep[1] / BEND_S
    for begins, h, v in (
        (push, CROUCHED + 0.5 * gain * push * push, gain * push),
        (fly, OFF + speed * fly - 0.5 * _G * fly * fly, speed - _G * fly),
        (land, OFF - speed * land + 0.5 * gain * land * land, gain * land - speed),
        (rise, CROUCHED + low * back[0], low * back[1] / RISE_S),
    ):
        height, rate = xp.where(begins > 0.0, h, height), xp.where(begins > 0.0, v, rate)
    return height, rate, (fly > 0.0) & (land < 0.0)


def _smooth(xp, share):
    """From 0 to 1 along half a cosine, and its slope."""
    angle = math.pi * xp.clip(share, 0.0, 1.0)
    return 0.5 - 0.5 * xp.cos(angle), 0.5 * math.pi * xp.sin(angle)


def wanted(s, ahead=0):
    """The reference now, or so many policy steps ahead."""
    return reference(s.xp, s.command[:, 0], s.elapsed + ahead * POLICY_S)


def height_ahead(s):
    """Commanded height of the trunk now and 2, 4 and 8 policy steps ahead, from where it stands [m]."""
    return s.xp.stack([wanted(s, k)[0] - STANDS for k in AHEAD], -1)


def speed_ahead(s):
    """Commanded vertical speed of the trunk now and 2, 4 and 8 policy steps ahead [m/s]."""
    return s.xp.stack([wanted(s, k)[1] for k in AHEAD], -1)


def height_tracking(s):
    """exp(-(height - command)^2 / (0.04 m)^2)."""
    return s.xp.exp(-s.xp.square((s.height - wanted(s)[0]) / 0.04))


def speed_tracking(s):
    """exp(-(vertical speed - command)^2 / (0.4 m/s)^2)."""
    return s.xp.exp(-s.xp.square((s.linear[:, 2] - wanted(s)[1]) / 0.4))


def feet_as_commanded(s):
    """Share of the feet that carry load, and in the flight of those that carry none."""
    flies = wanted(s)[2][:, None]
    loaded = s.foot_force > CONTACT_N
    return s.xp.sum((loaded != flies) * 1.0, -1) / 4.0


def command(draws, worlds, machine):
    """Apex [m]; three worlds in ten run the test."""
    drawn = draws.uniform((LOW,), (HIGH,), (worlds, 1))
    kind = draws.uniform((0.0,), (1.0,), (worlds, 1))
    return draws.xp.where(kind < 0.3, draws.constant((APEX,), (worlds, 1)), drawn)


def scores(log):
    """Apex of every jump [m], their mean."""
    height = log.get("base_pose")[:, 2]
    rows = round(PERIOD_S / STEP_S)
    tops = [float(height[i : i + rows].max()) for i in range(0, len(height) - rows + 1, rows)]
    return {"apex_m": float(np.mean(tops))} if tops else {}


TASK = replace(
    PITCH,
    name="jump",
    about="The robot jumps again and again to a commanded height of its trunk; the test is 0.50 m.",
    episode_s=3 * PERIOD_S,
    action_scale=0.5,
    observations=(
        *PITCH.observations[:-1],
        Observation("height_ahead", height_ahead, 10.0),
        Observation("speed_ahead", speed_ahead),
    ),
    rewards=(
        Reward("height_tracking", 3.0, height_tracking),
        Reward("speed_tracking", 2.0, speed_tracking),
        Reward("feet_as_commanded", 2.0, feet_as_commanded),
        Reward("alive", 0.5, t.alive),
        Reward("fall", -50.0, t.fall),
        Reward("tilt2", -5.0, t.tilt2),
        Reward("roll_pitch_rate2", -0.05, t.roll_pitch_rate2),
        Reward("roll_yaw_rate2", -0.05, t.roll_yaw_rate2),
        Reward("horizontal2", -1.0, t.horizontal2),
        Reward("slip2", -0.1, t.slip2),
        Reward("abduction2", -0.5, t.abduction2),
        Reward("torque2", -5e-5, t.torque2),
        Reward("joint_speed2", -1e-4, t.joint_speed2),
        Reward("action_rate2", -0.005, t.action_rate2),
        Reward("outside_limits", -2.0, t.outside_limits),
    ),
    command=command,
    trial=lambda machine: np.array([[APEX]]),
    scores=scores,
    randomisation="leg_rand",
    iterations=300,
)
