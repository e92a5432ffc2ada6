"""How noisy each sensor is, from the recording alone and whatever else is in it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from scipy.special import gammaincinv

from workbench.core import Recording

from .lattice import lattice_step

_WINDOW = 200  # rows; short beside any change of configuration, long enough to separate bands
_WINDOWS = 80  # per axis; more would sharpen the median below 1 %, which nothing needs
_BANDS = (0.25, 0.4, 0.6)  # parts of half the row rate taken to be motion; the rest is noise
_OWN = 0x5EED  # seed of noise that is added to see whether it comes out; nobody else draws from it
_PHASES = 12  # kinds of rows, where ticks lie between rows
_CLEARLY = 0.7  # of all rows' noise: of kinds that are alike one is quieter by chance, but not by so much
_REACH_S = 0.010  # a torque answers its command within delay and current loop, well inside this


@dataclass(frozen=True)
class NoiseLevels:
    """Sensor noise per axis, each array (n,); NaN where it cannot be known.

    Attributes:
        position_resolution: step of the encoder [rad or m]; 0 where positions lie on no lattice, NaN
            where the axis never moves.
        position_std: standard deviation of position noise, rounding included [rad or m].
        velocity_std: of velocity noise [rad/s or m/s]; NaN where velocity was not measured.
        torque_std: of measured torque's noise [N m or N]; NaN where torque was not measured.
    """

    position_resolution: np.ndarray
    position_std: np.ndarray
    velocity_std: np.ndarray
    torque_std: np.ndarray


def noise_levels(recording: Recording) -> NoiseLevels:
    """Noise of position, velocity and torque, each taken as white.

    In short windows everything that motion can explain is projected out, and what stays is noise:
    slow cosines for all signals, and for torque the last commands too (any delay and any linear
    current loop make the torque a weighted sum of them, so its steps at every controller tick do not
    count as noise). The median over windows ignores those in which friction, backlash or saturation
    strike, and the smallest of several bandwidths is taken, because motion only ever adds.
    """
    n = len(recording.axes)
    valid = np.ones(len(recording), bool) if recording.valid is None else recording.valid
    resolution, position = np.full(n, np.nan), np.full(n, np.nan)
    velocity, torque = np.full(n, np.nan), np.full(n, np.nan)
    measured_velocity = None if "velocity" in recording.derived else recording.get("velocity")
    measured_torque = recording.get("torque_measured")
    command = recording.get("torque_command")
    for i in range(n):
        q = recording.position[:, i]
        if np.ptp(q[valid]) > 0:
            resolution[i] = _resolution(recording, "position", i)
            rounding, white = resolution[i] / np.sqrt(12), white_noise(q, valid)
            # rounding leaves at most white noise of that size; a hard-driven axis adds some of its own
            position[i] = white if white >= 2 * rounding else rounding
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
    return NoiseLevels(resolution, position, velocity, torque)


def _resolution(recording: Recording, signal: str, axis: int) -> float:
    """Step of a signal's lattice, as the rows lie on it or lay on it when they were logged; 0 without one."""
    if signal in recording.steps:
        return float(recording.steps[signal][axis])
    return lattice_step(recording.signals[signal][recording.valid, axis])


def _phase(recording: Recording) -> np.ndarray | None:
    """Where each row (N,) lies between two ticks of the loop, as a number; None where all rows are at ticks.

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
    """Whether noise of speed that goes round the loop would be seen at all beside the command's integral.

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


def white_noise(
    signal: np.ndarray,
    valid: np.ndarray,
    command: np.ndarray | None = None,
    period: float = 1.0,
    *,
    integrated: bool = False,
    phase: np.ndarray | None = None,
    guessed: np.ndarray | None = None,
) -> float:
    """Standard deviation of the white noise on one signal.

    Args:
        signal: shape (N,).
        valid: rows to trust, shape (N,) bool.
        command: what the signal follows with some delay and lag, shape (N, m), or None.
        period: row period [s].
        integrated: the signal follows the command's integral, and never the same row's.
        phase: number (N,) of each row; rows of another number follow the command in another way.
        guessed: rows (N,) bool that have no noise of their own.

    Returns:
        The standard deviation, in the signal's unit; NaN where there are too few rows.
    """
    twice = command is not None and np.allclose(command[:, 0], signal, rtol=1e-9, atol=0)
    if command is None or np.ptp(command) == 0 or twice:
        lags = 0  # nothing to follow, or the same column twice
    else:
        lags = int(np.clip(np.ceil(_REACH_S / period), 4, 80)) + 1
    kinds = 1 if phase is None else int(phase.max()) + 1
    columns = lags * kinds * (1 if command is None else command.shape[1])
    gaps = np.concatenate([[0], np.cumsum(~valid)])
    width = min(max(_WINDOW, 6 * columns), len(signal) - lags)
    starts = np.zeros(0, int)
    while len(starts) == 0:  # where gaps leave no room, shorter ones
        width -= width % kinds  # all windows begin with the same kind
        if width < max(16, 3 * columns):
            return float("nan")
        starts = np.arange(lags + integrated, len(signal) - width + 1, width)
        starts = starts[gaps[starts + width] == gaps[starts - lags]]
        width //= 1 if len(starts) else 2
    starts = starts[np.linspace(0, len(starts) - 1, min(_WINDOWS, len(starts))).astype(int)]
    rows = starts[:, None] + np.arange(width)
    followed = None
    if command is not None and lags:
        taken = rows[:, :, None] - np.arange(lags) - (1 if integrated else 0)
        followed = command[taken].reshape(*rows.shape, -1)  # (windows, width, lags * m)
        followed = np.cumsum(followed, axis=1) if integrated else followed
        if phase is not None:
            of_kind = (phase[rows][:, :, None] == np.arange(kinds)).astype(float)
            followed = np.einsum("wri,wrk->wrik", followed, of_kind).reshape(*rows.shape, -1)
    if guessed is not None:
        own = _each_by_itself(guessed[rows])
        followed = own if followed is None else np.concatenate([followed, own], axis=2)
    bands = [round(width * band) for band in _BANDS]
    left = [_outside(signal[rows], followed, slow) for slow in bands]
    every = min(_usual(*each) for each in left)
    if followed is None or phase is None:
        return every
    quietest = _of_quietest(*left[0], bands[0], phase[rows[0]])
    return quietest if quietest < _CLEARLY * every else every


def _each_by_itself(chosen: np.ndarray) -> np.ndarray:
    """Columns (W, width, most) that are one in one of the chosen rows (W, width) each, and take it out."""
    most = int(chosen.sum(axis=1).max(initial=0))
    row = np.argsort(~chosen, axis=1, kind="stable")[:, None, :most]
    columns = np.zeros((*chosen.shape, most))
    np.put_along_axis(columns, row, 1.0, axis=1)
    return columns * chosen[:, :, None]


def _outside(windows: np.ndarray, followed: np.ndarray | None, slow: int) -> tuple[np.ndarray, np.ndarray]:
    """What of windows (W, width) lies outside the span of `slow` cosines and commands; its freedom (W,)."""
    width = windows.shape[1]
    basis = _slow_basis(width, slow)
    rest = windows - (windows @ basis) @ basis.T
    freedom = np.full(len(windows), float(width - basis.shape[1]))
    if followed is not None:
        commands = followed - basis @ (basis.T @ followed)
        across = np.swapaxes(commands, 1, 2)
        size, turned = np.linalg.eigh(across @ commands)
        # directions that only rounding sets apart explain nothing
        told = size > 1e-11 * size[:, -1:] + 1e-24
        along = (np.swapaxes(turned, 1, 2) @ (across @ rest[:, :, None]))[:, :, 0]
        share = np.where(told, along / np.where(told, size, 1.0), 0.0)
        rest = rest - (commands @ (turned @ share[:, :, None]))[:, :, 0]
        freedom -= told.sum(axis=1)
    return rest, freedom


def _usual(rest: np.ndarray, freedom: np.ndarray) -> float:
    """Noise that leaves so much with so much freedom, median over windows."""
    median = 2.0 * gammaincinv(0.5 * np.maximum(freedom, 1), 0.5)  # of a chi-squared variable
    return float(np.sqrt(np.median((rest**2).sum(axis=1) / median)))


def _of_quietest(rest: np.ndarray, freedom: np.ndarray, slow: int, kind: np.ndarray) -> float:
    """The same of the kind of rows that has least, (width,) numbers of kinds, alike in all windows.

    Where a row's torque answers a tick that no row shows, the noise that sensors had at that tick is in it,
    by the loop's gains. The kind whose ticks are logged shows the torque's own.
    """
    basis = _slow_basis(len(kind), slow)
    of_kind = (kind[:, None] == np.unique(kind)).astype(float)
    # slow cosines that take of a row take of its neighbours too, which are of other kinds
    mixed = of_kind.T @ (np.eye(len(kind)) - basis @ basis.T) ** 2 @ of_kind / of_kind.sum(axis=0)[:, None]
    power = np.median(rest**2 @ of_kind, axis=0) / of_kind.sum(axis=0)
    taken = np.median(freedom) / (len(kind) - basis.shape[1])  # by the commands, of all kinds alike
    own = np.linalg.solve(mixed, power / taken)
    return float(np.sqrt(own.min())) if own.min() > 0.0 else np.inf


@lru_cache(maxsize=32)
def _slow_basis(width: int, count: int) -> np.ndarray:
    """Orthonormal cosines, and the odd powers that they lack at a window's ends, (width, count + 2)."""
    place = (np.arange(width) + 0.5) / width
    cosines = np.cos(np.pi * place[:, None] * np.arange(count))
    ends = np.column_stack([place - 0.5, (place - 0.5) ** 3])
    return np.linalg.qr(np.hstack([cosines, ends]))[0]
