"""Experiments for what the demo's six do not show: presliding, limits, heat, cogging, wide gravity.

They too start at rest in the hold posture and keep the joints off their stops.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import Excitation

from .experiments import HOLD, ROW_PERIOD, Experiment

_RANGE = ((-1.35, 1.2), (0.5, 2.3))  # of hip and knee, away from their stops [rad]
_JOINTS = ("hip", "knee")


def revealing_experiments() -> tuple[Experiment, ...]:
    """Return all of them with their own lengths, 155 s in all."""
    return (range_sweep(), dither(), steps(), speed_ladder("hip"), speed_ladder("knee"), work_and_rest())


def range_sweep() -> Experiment:
    """Hip, then knee, goes down, up and back through its range at 0.35 rad/s.

    Every angle is passed both ways: for gravity, springs and friction over position, eccentricity, cogging.
    """
    legs = []
    for joint, (low, high) in enumerate(_RANGE):
        legs.append(_moved(joint, _through([HOLD[joint], low, high, HOLD[joint]], 0.35)))
    return _reference("range_sweep", np.concatenate(legs))


def dither(duration: float = 12.0) -> Experiment:
    """Both joints oscillate at about 1 Hz, their amplitude growing steadily from 0.001 to 0.06 rad.

    Small motion stays in presliding, in a gap, in a spring; where it breaks away shows the friction's level.
    """
    t = np.arange(round(duration / ROW_PERIOD)) * ROW_PERIOD
    size = 1e-3 * 60.0 ** (t / duration)
    waves = np.column_stack([size * np.sin(2 * np.pi * f * t) for f in (1.0, 1.3)])
    return _reference("dither", HOLD + waves)


def steps(sizes: Sequence[float] = (0.05, 0.15, 0.3, 0.42), hold: float = 0.5) -> Experiment:
    """Steps of either joint, each way from the hold posture, larger and larger [rad]; each is held [s].

    At 50 N m/rad the largest asks for most of what a drive can give: for torque and speed limits.
    """
    rows = round(hold / ROW_PERIOD)
    away = [
        np.tile(shift * np.eye(2)[joint], (rows, 1))
        for size in sizes
        for joint in range(2)
        for shift in (0.0, size, 0.0, -size)
    ]
    return _reference("steps", HOLD + np.concatenate([*away, np.zeros((rows, 2))]))


def speed_ladder(joint: str, speeds: Sequence[float] = (0.1, 0.3, 1.0, 2.5)) -> Experiment:
    """One joint to and fro about the hold posture, 0.35 rad each way, at one speed [rad/s] after another.

    What belongs to position repeats at every speed, what belongs to speed does not.
    """
    index = _JOINTS.index(joint)
    corners = HOLD[index] + np.array([0.0, 0.35, -0.35, 0.0])
    turns = [_through(corners, speed) for speed in speeds]
    return _reference(f"ladder_{joint}", _moved(index, np.concatenate(turns)))


def work_and_rest(spell: float = 15.0, spells: int = 4) -> Experiment:
    """Both joints swing hard for a spell [s], rest for one, and so on: drives warm up and cool down.

    0.2 rad at 4 Hz: at first about 6 and 5 N m rms on the two motors.
    """
    t = np.arange(round(spell * spells / ROW_PERIOD)) * ROW_PERIOD
    working = (t // spell % 2 == 0) * np.minimum(1.0, np.minimum(t % spell, spell - t % spell))
    swing = 0.2 * working * np.sin(2 * np.pi * 4.0 * t)
    return _reference("work_and_rest", HOLD + np.column_stack([swing, swing]))


def _reference(name: str, reference: np.ndarray) -> Experiment:
    return Experiment(name, reference, np.zeros_like(reference), Excitation("reference"))


def _through(angles: Sequence[float] | np.ndarray, speed: float) -> np.ndarray:
    """From angle to angle at constant speed (N,), the first angle included and the last left out."""
    corners = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(angles)))]) / speed
    return np.interp(np.arange(0.0, corners[-1], ROW_PERIOD), corners, angles)


def _moved(joint: int, angles: np.ndarray) -> np.ndarray:
    """References of both joints (N, 2) where one has these angles (N,) and the other holds."""
    reference = np.tile(HOLD, (len(angles), 1))
    reference[:, joint] = angles
    return reference
