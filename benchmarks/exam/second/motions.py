"""What the second leg is asked to do: other motions than the demo's, drawn anew for every case.

Each starts at rest: references begin flat. Two of the six are torques on one motor each, on odd lines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import Excitation

PERIOD = 1e-3  # s
RANGE = ((-1.35, 1.1), (0.5, 2.3))  # of hip and knee, well inside their stops [rad]


@dataclass(frozen=True, eq=False)
class Motion:
    """One run: joint references (N, 2) [rad], motor feedforward (N, 2) [N m], rows of `period` [s]."""

    name: str
    reference: np.ndarray
    feedforward: np.ndarray
    excitation: Excitation
    period: float = PERIOD


def motions(seed: int = 0) -> tuple[Motion, ...]:
    """Six motions, 46 s in all; the last is to judge by. `seed` draws postures, phases and lines."""
    draw = np.random.default_rng([seed, 223])
    posture = np.array([draw.uniform(-0.7, -0.35), draw.uniform(0.95, 1.35)])
    return (
        _sweep(posture, draw),
        _torques(posture, draw, 0, 0.9),
        _torques(posture, draw, 1, 0.55),
        _ramps(posture, draw),
        _wander("wander", posture, draw, 7.0, 2.5),
        _judge(posture, draw),
    )


def _sweep(posture: np.ndarray, draw: np.random.Generator, duration: float = 7.0) -> Motion:
    """The hip's frequency rises evenly while the knee's falls, amplitudes less the faster."""
    t = _clock(duration)
    low, high = 0.2, draw.uniform(14.0, 20.0)
    rising = low + (high - low) * t / duration
    waves = []
    for f in (rising, rising[::-1]):
        turns = np.cumsum(f) * PERIOD
        waves.append(0.22 / np.sqrt(1 + f / 3) * np.sin(2 * np.pi * (turns - turns[0])) * _fade(t, duration))
    reference = posture + np.column_stack(waves)
    return Motion(
        "sweep", reference, np.zeros_like(reference), Excitation("chirp", f_min_hz=low, f_max_hz=high)
    )


def _torques(
    posture: np.ndarray, draw: np.random.Generator, motor: int, rms: float, period: float = 4.0
) -> Motion:
    """Odd lines with random phases on one motor, two periods and a quarter, while the loop holds."""
    t = _clock(2.25 * period)
    top = draw.uniform(35.0, 55.0)
    lines = np.arange(1, round(top * period), 2)
    turns = np.outer(t, lines) / period + draw.uniform(0, 1, len(lines))
    feedforward = np.zeros((len(t), 2))
    feedforward[:, motor] = rms * np.sqrt(2 / len(lines)) * np.cos(2 * np.pi * turns).sum(axis=1)
    excitation = Excitation("multisine", "single", period, 1 / period, float(lines[-1] / period), "odd")
    return Motion(f"torque_{('hip', 'knee')[motor]}", np.tile(posture, (len(t), 1)), feedforward, excitation)


def _ramps(posture: np.ndarray, draw: np.random.Generator, duration: float = 9.0) -> Motion:
    """Both joints to and fro between random corners at constant speeds [rad/s], by no common clock."""
    t = _clock(duration)
    columns = []
    for joint, reach in enumerate((0.55, 0.5)):
        corners, times, side = [posture[joint]], [0.0], draw.choice([-1.0, 1.0])
        while times[-1] < duration:
            corners.append(posture[joint] + side * reach * draw.uniform(0.4, 1.0))
            times.append(times[-1] + abs(corners[-1] - corners[-2]) / draw.uniform(0.3, 0.9))
            side = -side
        columns.append(np.interp(t, times, corners))
    reference = _within(np.column_stack(columns))
    return Motion("ramps", reference, np.zeros_like(reference), Excitation("reference"))


def _wander(name: str, posture: np.ndarray, draw: np.random.Generator, duration: float, top: float) -> Motion:
    """Both joints follow smooth random curves of frequencies up to `top` [Hz]."""
    t = _clock(duration)
    columns = []
    for reach in (0.4, 0.4):
        tones = draw.uniform(0.15, top, 12)
        turns = np.outer(t, tones) + draw.uniform(0, 1, 12)
        curve = np.sin(2 * np.pi * turns) @ (1 / (1 + tones))
        columns.append(reach * curve / np.abs(curve).max() * _fade(t, duration))
    reference = _within(posture + np.column_stack(columns))
    return Motion(name, reference, np.zeros_like(reference), Excitation("reference"))


def _judge(posture: np.ndarray, draw: np.random.Generator, duration: float = 5.0) -> Motion:
    """Faster curves, and noise-like torque on both motors."""
    motion = _wander("judge", posture, draw, duration, 5.0)
    t = _clock(duration)
    lines = np.arange(15, 300) / duration  # Hz, from 3 to 60
    for motor, rms in enumerate((0.45, 0.3)):
        turns = np.outer(t, lines) + draw.uniform(0, 1, len(lines))
        motion.feedforward[:, motor] = rms * np.sqrt(2 / len(lines)) * np.cos(2 * np.pi * turns).sum(axis=1)
    return motion


def _within(reference: np.ndarray) -> np.ndarray:
    return np.clip(reference, [low for low, _ in RANGE], [high for _, high in RANGE])


def _fade(t: np.ndarray, duration: float, rise: float = 0.6) -> np.ndarray:
    """From 0 to 1 within `rise` [s], smoothly, and back at the end."""
    near = np.clip(np.minimum(t, duration - t) / rise, 0.0, 1.0)
    return near * near * (3 - 2 * near)


def _clock(duration: float) -> np.ndarray:
    return np.arange(round(duration / PERIOD)) * PERIOD
