"""Frequency responses: the estimate over what scipy and python-control give from the same record."""

from __future__ import annotations

import control
import numpy as np
from frf_speed import made, ways
from scipy.signal import csd, lfilter
from side_by_side import spread, times_as_long

from workbench.core import Recording
from workbench.frf import estimate, multisine

from .row import Part, Row

_RATE, _PERIOD_S, _PERIODS = 500.0, 2.0, 10  # Hz, s
_WIDE, _LAST = 245.0, 60.0  # Hz: excited, as Markov parameters need it up to half the rate; judged
_MARKOV = 200  # parameters: 0.4 s, by when the response has died out


def measure(quick: bool) -> list[Row]:
    """Time against loops that give the same numbers; error and time against other estimators."""
    axes, periods, repeats = (3, 20, 3) if quick else (12, 100, 3)
    recordings, rows = made(axes, periods, 1.0), round(_RATE)
    lines = np.arange(2, 101)
    found = []
    for name, options, loop in ways(1.0, lines):
        ratio = times_as_long(
            lambda o=options: estimate(recordings, **o), lambda f=loop: f(recordings, rows, lines), repeats
        )
        found.append(
            Row(f"time, {axes} axes, {name}", "scipy's transform in a loop, same numbers", str(ratio))
        )
    seeds = range(5 if quick else 25)
    records = [_record(seed) for seed in seeds]
    ours = [_error(*_ours(r)) for r in records]
    for name, other in (("scipy.signal.csd, H1", _h1), ("python-control's markov", _markov)):
        theirs = [_error(*other(r)) for r in records]
        errors = spread(np.array(ours) / np.array(theirs))
        found.append(Row("error of the response, one axis with noise", name, str(errors)))
        time = times_as_long(lambda: _ours(records[0]), lambda o=other: o(records[0]), 5)
        found.append(Row("time of it", name, str(time)))
    return found


def _true(frequency: np.ndarray) -> np.ndarray:
    """Of a held torque to speed: first order with 4 Hz, one row late."""
    z = np.exp(2j * np.pi * frequency / _RATE)
    pole = np.exp(-2 * np.pi * 4.0 / _RATE)
    return (1 - pole) / (z - pole)


def _record(seed: int) -> Recording:
    """Ten periods of a multisine from rest, with noise of a tenth of the response."""
    design = multisine(
        ["axis"], f_min_hz=1 / _PERIOD_S, f_max_hz=_WIDE, period_s=_PERIOD_S, rate_hz=_RATE, phases="random",
        periods=_PERIODS, transient_periods=1,
    )  # fmt: skip
    u = design.play(0)[1]["torque_feedforward"]
    pole = np.exp(-2 * np.pi * 4.0 / _RATE)
    y = lfilter([0.0, 1 - pole], [1.0, -pole], u, axis=0)
    y = y + 0.1 * y.std() * np.random.default_rng(seed).normal(size=y.shape)
    return Recording(
        name="run", axes=("axis",), coordinates="actuator", time=np.arange(len(u)) / _RATE,
        signals={"position": y, "velocity": y, "torque_measured": u}, units=("rad",),
        excitation=design.excitation(0),
    )  # fmt: skip


def _ours(r: Recording) -> tuple[np.ndarray, np.ndarray]:
    frf = estimate([r], reference=None, period_s=_PERIOD_S, transient_periods=1)
    asked = frf.frequency <= _LAST
    return frf.frequency[asked], frf.response[asked, 0, 0]


def _h1(r: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Spectra of one period a segment, without a window: the multisine has no leakage."""
    rows = round(_RATE * _PERIOD_S)
    u, y = r.signals["torque_measured"][rows:, 0], r.velocity[rows:, 0]
    settings = {"fs": _RATE, "window": "boxcar", "nperseg": rows, "noverlap": 0, "detrend": False}
    frequency, cross = csd(u, y, **settings)
    asked = (frequency > 0) & (frequency <= _LAST)
    return frequency[asked], cross[asked] / csd(u, u, **settings)[1][asked]


def _markov(r: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Its impulse response by least squares, transformed."""
    h = np.asarray(control.markov(r.velocity.T, r.signals["torque_measured"].T, _MARKOV, dt=1 / _RATE))
    frequency = np.arange(1, round(_LAST * _PERIOD_S) + 1) / _PERIOD_S
    shift = np.exp(-2j * np.pi * np.outer(frequency, np.arange(_MARKOV)) / _RATE)
    return frequency, shift @ h.ravel() / _RATE  # it gives the response to an impulse of height 1 / dt


def _error(frequency: np.ndarray, response: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.abs(response / _true(frequency) - 1) ** 2)))


PART = Part(
    "responses",
    "Frequency responses",
    "The estimate against loops with scipy's transform that give the same numbers (only the time differs), "
    "and against two other estimators of a response with known truth: scipy's cross spectra and "
    "python-control's Markov parameters, which know that impulse responses are short. Only ours comes with a "
    "covariance.",
    measure,
    "python benchmarks/frf_speed.py",
)
