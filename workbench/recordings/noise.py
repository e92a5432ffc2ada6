"""Sensor noise, estimated from the recording alone."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from workbench.core import Recording
from workbench.core.once import once_per_recording

from .encoder_noise import position_noise
from .quantisation import quantisation_step
from .white_noise import white_noise

_OWN = 0x5EED  # seed of noise that is added to see whether it comes out; nobody else draws from it
_PHASES = 12  # kinds of rows, where ticks lie between rows


@dataclass(frozen=True)
class NoiseLevels:
    """Sensor noise per axis, each array (n,); NaN where it is unknown.

    Attributes:
        position_resolution: step of the encoder [rad or m]; 0 where positions are multiples of none, NaN
            where the axis never moves.
        position_std: standard deviation of position noise, rounding included [rad or m].
        velocity_std: of velocity noise [rad/s or m/s]; NaN where velocity was not measured.
        torque_std: of measured torque's noise [N m or N]; NaN where torque was not measured.
    """

    position_resolution: np.ndarray
    position_std: np.ndarray
    velocity_std: np.ndarray
    torque_std: np.ndarray


@once_per_recording
def noise_levels(recording: Recording) -> NoiseLevels:
    """Return noise of position, velocity and torque, each assumed white.

    In short windows everything that motion can explain is projected out, and what stays is noise:
    slow cosines for all signals, and for torque the last commands too (any delay and any linear
    current loop make the torque a weighted sum of them, so its steps at every controller tick do not
    count as noise). The median over windows ignores those in which friction, backlash or saturation
    strike, and the smallest of several bandwidths is taken, because motion only ever adds.
    """
    n = len(recording.axes)
    valid = recording.valid
    velocity, torque = np.full(n, np.nan), np.full(n, np.nan)
    measured_velocity = None if "velocity" in recording.derived else recording.get("velocity")
    measured_torque = recording.get("torque_measured")
    command = recording.get("torque_command")
    for i in range(n):
        if measured_velocity is not None:
            v = measured_velocity[:, i]
            white = _velocity_noise(v, valid, command, i, recording.period)
            # where an axis mostly stands, most windows show no rounding
            rounding = _resolution(recording, "velocity", i) / np.sqrt(12)
            velocity[i] = white if white >= rounding else rounding or white
        if measured_torque is not None:
            asked = None if command is None else command[:, i : i + 1]
            phase = None if asked is None else _phase(recording)
            guessed = recording.guessed.get("torque_measured")
            white = white_noise(
                measured_torque[:, i], valid, asked, recording.period, phase=phase, guessed=guessed
            )
            rounding = _resolution(recording, "torque_measured", i) / np.sqrt(12)
            torque[i] = white if white >= rounding else rounding or white
    resolution, position = position_levels(recording)
    return NoiseLevels(resolution, position, velocity, torque)


@once_per_recording
def position_levels(recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Resolution of the encoder and deviation of position noise alone, (n,) each, as in `NoiseLevels`."""
    n = len(recording.axes)
    valid = recording.valid
    moves = np.ptp(recording.position[valid], axis=0) > 0
    steps = [_resolution(recording, "position", i) if moves[i] else np.nan for i in range(n)]
    resolution = np.array(steps)
    return resolution, position_noise(recording.position, valid, resolution)


def _resolution(recording: Recording, signal: str, axis: int) -> float:
    """Return the resolution of a signal, from its rows or from those it was logged at; 0 if it has none."""
    if signal in recording.steps:
        return float(recording.steps[signal][axis])
    return quantisation_step(recording.signals[signal][recording.valid, axis])


def _phase(recording: Recording) -> np.ndarray | None:
    """Return each row's phase between two ticks of the loop (N,) as a number; None if all are at ticks.

    Where ticks lie between rows, a row's torque answers now this command and now the one before.
    """
    tick = recording.controller.period_s
    if tick is None:
        return None
    rows_a_tick = Fraction(tick / recording.period).limit_denominator(_PHASES)
    if rows_a_tick.denominator == 1 or not 1 < rows_a_tick.numerator <= _PHASES:
        return None
    return np.arange(len(recording)) * rows_a_tick.denominator % rows_a_tick.numerator


def _velocity_noise(
    v: np.ndarray, valid: np.ndarray, command: np.ndarray | None, axis: int, period: float
) -> float:
    plain = white_noise(v, valid)
    if command is None:
        return plain
    # where the log is slow, hard commands move the axis up to half the row rate: take their integral
    # out. Feedback carries this very noise in the command, so that only a clear gain is believed.
    every = command if command.shape[1] <= 4 else command[:, axis : axis + 1]
    driven = white_noise(v, valid, every, period, integrated=True)
    return driven if driven < 0.7 * plain and _seen(v, valid, every, axis, period, plain, driven) else plain


def _seen(
    v: np.ndarray, valid: np.ndarray, every: np.ndarray, axis: int, period: float, plain: float, driven: float
) -> bool:
    """Return whether speed noise through the loop would be visible beside the command's integral.

    Above the slow cosines a signal can be told from its own neighbours, and so noise from the command that
    answers it. Noise is added, to the speed and by the loop's gain to the command: it has to come out.
    """
    k = axis if every.shape[1] > 1 else 0
    # the gain at which the command answers the same row's speed, by their fastest parts
    fast, answer = np.diff(v, 4), np.diff(every[:, k], 4)
    gain = min(0.0, float(fast @ answer / max(fast @ fast, 1e-300)))  # a loop damps
    added = np.random.default_rng(_OWN).normal(0.0, plain, len(v))
    answered = every.copy()
    answered[:, k] += gain * added
    both = white_noise(v + added, valid, answered, period, integrated=True)
    return both**2 - driven**2 > 0.5 * plain**2
