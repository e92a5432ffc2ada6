"""Multisines for one axis or many: lines, amplitudes, phases, mixing, realisations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np

from workbench.core import InputError

from .excitation import Design, Driven, Trial
from .lines import Grid, select_lines
from .mixing import Mixing, mixing_matrix, mode_name
from .phases import low_crest_phases, random_phases, schroeder_phases, synthesise

_MOST = 100_000_000  # samples of a period


def multisine(
    axes: Sequence[str],
    *,
    f_min_hz: float,
    f_max_hz: float,
    period_s: float,
    rate_hz: float,
    rms: float | Sequence[float] = 1.0,
    shape: Callable[[np.ndarray], np.ndarray] | None = None,
    grid: Grid = "full",
    per_decade: int | None = None,
    phases: Literal["schroeder", "low_crest", "random"] = "schroeder",
    mixing: Mixing = "orthogonal",
    own_phases: bool = False,
    realisations: int = 1,
    periods: int = 4,
    transient_periods: int = 1,
    driven: Driven = "torque_feedforward",
    hold: Sequence[float] = (),
    fade_s: float = 0.0,
    seed: int = 0,
    name: str = "multisine",
) -> Design:
    """Return a set of multisine experiments: n per realisation, which separate n axes.

    Args:
        axes: names of the driven axes, n of them.
        f_min_hz, f_max_hz, period_s, grid, per_decade: the lines; see `select_lines`.
        rate_hz: samples per second; a period must be a whole number of samples.
        rms: root mean square of each axis in an experiment that drives it, one or n numbers.
        shape: relative amplitude at each frequency [Hz], (F,) -> (F,) >= 0; None: all alike.
        phases: ``"schroeder"`` (low crest factor for neighbouring lines), ``"low_crest"`` (for sparse ones
            too), both for one realisation, or ``"random"`` (nonlinear distortion then differs from
            realisation to realisation, and its variance can be measured).
        mixing: see `mixing_matrix`.
        own_phases: with random phases, each axis has its own; else all share one set, as the sum and
            difference modes of a pair do.
        realisations: sets of experiments with new phases each.
        periods, transient_periods, driven, hold, fade_s: see `Design`.
        seed: draws phases and silent lines.
        name: the design's name, and the stem of its experiments' names.

    Raises:
        InputError: a band, rate, amplitude or combination that cannot be played.
    """
    rows = _rows(period_s, rate_hz)
    # before any line is made: of a band far beyond the rate there would be too many to hold
    if np.isfinite(f_max_hz) and f_max_hz >= rate_hz / 2:
        raise InputError(
            f"lines up to {f_max_hz:g} Hz at a rate of {rate_hz:g} Hz", column="f_max_hz",
            remedy=f"lower f_max_hz below {rate_hz / 2:g} Hz, or raise the rate",
        )  # fmt: skip
    lines = select_lines(f_min_hz, f_max_hz, period_s, grid=grid, per_decade=per_decade, seed=seed)
    if 2 * lines[-1] >= rows:
        problem = f"lines up to {f_max_hz:g} Hz at a rate of {rate_hz:g} Hz"
        remedy = f"lower f_max_hz below {rate_hz / 2:g} Hz, or raise the rate"
        raise InputError(problem, column="f_max_hz", remedy=remedy)
    if realisations < 1 or (realisations > 1 and phases != "random"):
        problem = f"{realisations} realisations with {phases} phases"
        raise InputError(problem, column="realisations", remedy="more than one need random phases")
    if own_phases and phases != "random":
        problem = f"{phases} phases are the same for every axis"
        raise InputError(problem, column="own_phases", remedy="take random phases")
    amplitudes = _amplitudes(lines / period_s, np.asarray(rms, float), len(axes), shape)
    matrix = mixing_matrix(len(axes), mixing)
    generator = np.random.default_rng([seed, 1])
    sets = []
    for _ in range(realisations):
        if own_phases:
            angle = np.stack([random_phases(len(lines), generator) for _ in axes])
        elif phases == "random":
            angle = np.tile(random_phases(len(lines), generator), (len(axes), 1))
        elif phases == "low_crest":
            angle = np.tile(low_crest_phases(lines, amplitudes[:, 0], rows), (len(axes), 1))
        else:
            angle = np.tile(schroeder_phases(lines, amplitudes[:, 0]), (len(axes), 1))
        sets.append(matrix[:, :, None] * (amplitudes.T * np.exp(1j * angle)))
    spectrum = np.concatenate(sets)
    return Design(
        name=name,
        kind="multisine",
        axes=tuple(axes),
        driven=driven,
        rate_hz=rate_hz,
        experiments=np.swapaxes(synthesise(lines, spectrum, rows), 1, 2),
        lines=lines,
        trials=name_trials(name, axes, matrix, realisations),
        grid=grid,
        periods=periods,
        transient_periods=transient_periods,
        hold=tuple(float(x) for x in hold),
        fade_s=fade_s,
    )


def name_trials(name: str, axes: Sequence[str], matrix: np.ndarray, realisations: int) -> tuple[Trial, ...]:
    """Return the trials of a set, named after what they drive: ``leg_sum``, ``leg_hip``, ``arm_3``..."""
    trials = []
    for m in range(realisations):
        for e, row in enumerate(matrix):
            mode = mode_name(row)
            word = axes[int(np.argmax(np.abs(row)))] if mode == "single" else mode or str(e + 1)
            parts = [name, word] if len(axes) > 1 else [name]
            parts += [str(m + 1)] if realisations > 1 else []
            trials.append(Trial("_".join(parts), mode, m))
    return tuple(trials)


def _rows(period_s: float, rate_hz: float) -> int:
    """Return the number of samples per period."""
    if not (np.isfinite(rate_hz) and rate_hz > 0):
        raise InputError(f"a rate of {rate_hz:g} Hz", column="rate_hz", remedy="give a positive rate")
    if not (np.isfinite(period_s) and period_s > 0):
        raise InputError(f"a period of {period_s:g} s", column="period_s", remedy="give a positive period")
    rows = round(period_s * rate_hz)
    if rows > _MOST:
        raise InputError(
            f"a period of {period_s:g} s is {rows:.3g} samples at {rate_hz:g} Hz", column="period_s",
            remedy=f"shorten it: {_MOST:.0e} samples are the most",
        )  # fmt: skip
    if rows < 4 or abs(rows - period_s * rate_hz) > 1e-6 * rows:
        raise InputError(
            f"a period of {period_s:g} s is {period_s * rate_hz:g} samples at {rate_hz:g} Hz",
            column="period_s", remedy=f"take a whole number of samples, e.g. {max(rows, 4) / rate_hz:.9g} s",
        )  # fmt: skip
    return rows


def _amplitudes(
    frequency: np.ndarray, rms: np.ndarray, n: int, shape: Callable[[np.ndarray], np.ndarray] | None
) -> np.ndarray:
    """Return the amplitude of each line and axis, (F, n), with the wanted root mean square."""
    if rms.shape not in ((), (1,), (n,)) or not np.isfinite(rms).all() or (rms <= 0).any():
        problem = f"amplitudes {np.atleast_1d(rms).tolist()} for {n} axes"
        raise InputError(problem, column="rms", remedy="give one positive number, or one per axis")
    relative = np.ones(len(frequency)) if shape is None else np.asarray(shape(frequency), float)
    if relative.shape != frequency.shape or not np.isfinite(relative).all() or (relative <= 0).any():
        raise InputError(
            "the amplitude shape is not positive everywhere", column="shape", remedy="correct it"
        )
    relative = relative * np.sqrt(2 / np.sum(relative**2))
    return relative[:, None] * np.broadcast_to(rms, (n,))
