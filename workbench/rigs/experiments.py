"""Experiments of the demo: references and feedforwards of the leg.

References are joint angles (hip, knee between the links), feedforwards actuator torques; both have one row
per millisecond. Six experiments, each for a purpose: chirps for inertia, a multisine on the sum and one on
the difference of the motors for the two modes of the coupled leg, a slow sweep for friction and gravity, and
another kind of motion to validate on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from workbench.core import Excitation, Recording

ROW_PERIOD = 1e-3  # s
HOLD = np.array([-0.55, np.pi / 3])  # joint angles of the hold posture [rad]


@dataclass(frozen=True, eq=False)
class Experiment:
    """One run.

    Attributes:
        name: becomes the recording's name.
        reference: joint angles asked for, (N, 2) [rad]; the run starts at rest at the first row.
        feedforward: torque added at the controller's ticks, actuator coordinates, (N, 2) [N m].
        excitation: its kind, for the recording's description.
        period: of the rows [s].
    """

    name: str
    reference: np.ndarray
    feedforward: np.ndarray
    excitation: Excitation
    period: float = ROW_PERIOD

    @classmethod
    def replay(cls, recording: Recording) -> Experiment:
        """Return the experiment of a recording of the leg: same reference, feedforward and rows."""
        reference = np.array(recording.signals["position_reference"], float)
        feedforward = np.array(recording.signals.get("torque_feedforward", np.zeros_like(reference)), float)
        period = round(recording.period, 12)
        return cls(recording.name, reference, feedforward, recording.excitation, period)

    def at_period(self, period: float) -> Experiment:
        """Return the same motion with rows of another `period` [s], interpolated linearly."""
        rows = round(len(self.reference) * self.period / period)
        t, own = np.arange(rows) * period, np.arange(len(self.reference)) * self.period

        def resampled(values: np.ndarray) -> np.ndarray:
            return np.column_stack([np.interp(t, own, column) for column in values.T])

        return replace(
            self, reference=resampled(self.reference), feedforward=resampled(self.feedforward), period=period
        )


def demo_experiments(seed: int = 0) -> tuple[Experiment, ...]:
    """Return the six experiments of the demo, 59 s in all; `seed` draws the validation motion."""
    return (
        chirp("hip"),
        chirp("knee"),
        multisine("sum"),
        multisine("difference"),
        slow_sweep(),
        validation(seed),
    )


def chirp(
    joint: str, amplitude: float = 0.2, f_min: float = 0.1, f_max: float = 25.0, duration: float = 8.0
) -> Experiment:
    """Return a chirp: the reference of one joint sweeps exponentially from `f_min` to `f_max` [Hz] with
    `amplitude` [rad].
    """
    t = _clock(duration)
    growth = duration / np.log(f_max / f_min)
    phase = 2 * np.pi * f_min * growth * np.expm1(t / growth)
    reference = np.tile(HOLD, (len(t), 1))
    reference[:, ("hip", "knee").index(joint)] += amplitude * np.sin(phase)
    excitation = Excitation("chirp", f_min_hz=f_min, f_max_hz=f_max)
    return Experiment(f"chirp_{joint}", reference, np.zeros_like(reference), excitation)


def multisine(
    mode: str,
    rms: tuple[float, float] = (0.9, 0.54),
    f_max: float = 60.0,
    period: float = 5.0,
    duration: float = 11.0,
) -> Experiment:
    """Return a torque multisine with Schroeder phases on both motors: in phase (``sum``) or against it.

    `rms` [N m] a motor; all lines from 1/`period` to `f_max` [Hz].
    """
    t = _clock(duration)
    count = round(f_max * period)
    order = np.arange(1, count + 1)
    phases = -np.pi * order * (order - 1) / count
    tone = np.sqrt(2 / count) * np.cos(2 * np.pi * np.outer(t, order) / period + phases).sum(axis=1)
    sign = {"sum": 1.0, "difference": -1.0}[mode]
    feedforward = np.outer(tone, [rms[0], sign * rms[1]])
    reference = np.tile(HOLD, (len(t), 1))
    excitation = Excitation("multisine", mode, period, 1 / period, f_max, "full")
    name = {"sum": "multisine_sum", "difference": "multisine_diff"}[mode]
    return Experiment(name, reference, feedforward, excitation)


def slow_sweep(duration: float = 15.0) -> Experiment:
    """Return a sweep: references move slowly through most of the range, without a common period."""
    t = _clock(duration)
    hip = 0.55 * np.sin(2 * np.pi * 0.10 * t)
    knee = 0.5 * (np.sin(2 * np.pi * 0.07 * t + 1.0) - np.sin(1.0))
    reference = HOLD + np.column_stack([hip, knee])
    return Experiment("slow", reference, np.zeros_like(reference), Excitation("reference"))


def validation(seed: int, duration: float = 6.0) -> Experiment:
    """Return five random tones in each reference, 0.5 to 6 Hz, and a random multisine per motor."""
    generator = np.random.default_rng([seed, 6])
    t = _clock(duration)
    frequencies = np.geomspace(0.5, 6.0, 6)
    reference = np.tile(HOLD, (len(t), 1))
    feedforward = np.zeros_like(reference)
    lines = np.arange(6, 81)  # Hz
    for axis, rms in enumerate((0.5, 0.3)):
        tones = np.exp(generator.uniform(np.log(frequencies[:-1]), np.log(frequencies[1:])))
        phases = generator.uniform(0, 2 * np.pi, len(tones))
        amplitudes = 0.15 / np.sqrt(tones / frequencies[0])
        waves = amplitudes * (np.sin(2 * np.pi * np.outer(t, tones) + phases) - np.sin(phases))
        reference[:, axis] += waves.sum(axis=1)
        shift = generator.uniform(0, 2 * np.pi, len(lines))
        tone = np.cos(2 * np.pi * np.outer(t, lines) + shift).sum(axis=1)
        feedforward[:, axis] = rms * np.sqrt(2 / len(lines)) * tone
    reference = _within_limits(reference)
    return Experiment("validation", reference, feedforward, Excitation("reference"))


def _within_limits(reference: np.ndarray) -> np.ndarray:
    """Shrinks a motion about its start so that both joints keep off their stops (N, 2) [rad]."""
    low, high = np.array([-1.3, 0.55]), np.array([0.3, 1.9])
    away = reference - reference[0]
    room = np.minimum(
        (high - reference[0]) / np.maximum(away.max(axis=0), 1e-9),
        (reference[0] - low) / np.maximum(-away.min(axis=0), 1e-9),
    )
    return reference[0] + away * np.minimum(room, 1.0)


def _clock(duration: float) -> np.ndarray:
    return np.arange(round(duration / ROW_PERIOD)) * ROW_PERIOD
