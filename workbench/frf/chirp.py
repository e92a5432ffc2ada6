"""Chirps: one sine that sweeps through the band, once per period."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from workbench.core import InputError

from .excitation import Design, Driven
from .lines import select_lines
from .mixing import Mixing, mixing_matrix
from .multisine import name_trials


def chirp(
    axes: Sequence[str],
    *,
    f_min_hz: float,
    f_max_hz: float,
    duration_s: float,
    rate_hz: float,
    amplitude: float | Sequence[float] = 1.0,
    sweep: Literal["linear", "logarithmic"] = "logarithmic",
    mixing: Mixing = "single",
    periods: int = 1,
    transient_periods: int = 0,
    driven: Driven = "position_reference",
    hold: Sequence[float] = (),
    name: str = "chirp",
) -> Design:
    """Return a set of chirps: n experiments that tell n axes apart.

    A logarithmic sweep stays equally long in every octave, a linear one equally long in every hertz. Both
    begin at zero. Pintelon and Schoukens 2012, ch. 5 (swept sine).

    Args:
        axes: names of the driven axes, n of them.
        f_min_hz, f_max_hz: where the sweep begins and ends [Hz].
        duration_s: of one sweep [s].
        rate_hz: samples per second.
        amplitude: of each axis, one or n numbers, in the signal's unit.
        sweep: how the frequency grows.
        mixing: ``"single"`` or one of the sets of signs; see `mixing_matrix`.
        periods, transient_periods: sweeps to play, and sweeps before these.
        driven, hold, name: see `Design`.

    Raises:
        InputError: numbers that make no sweep, a set of phase rotations, or a band above half the rate.
    """
    numbers = (f_min_hz, f_max_hz, duration_s, rate_hz)
    if not (np.isfinite(numbers).all() and 0 < f_min_hz < f_max_hz and duration_s > 0 and rate_hz > 0):
        problem = f"a sweep from {f_min_hz:g} to {f_max_hz:g} Hz in {duration_s:g} s at {rate_hz:g} Hz"
        raise InputError(problem, column="f_min_hz", remedy="give 0 < f_min_hz < f_max_hz, positive times")
    if 2 * f_max_hz >= rate_hz:
        problem = f"a sweep up to {f_max_hz:g} Hz at a rate of {rate_hz:g} Hz"
        raise InputError(problem, column="f_max_hz", remedy="lower f_max_hz or raise the rate")
    matrix = mixing_matrix(len(axes), mixing)
    if np.abs(matrix.imag).max() > 1e-9:
        problem = f"a chirp of {len(axes)} axes cannot rotate its phases"
        raise InputError(problem, column="mixing", remedy="take 'single'")
    size = np.asarray(amplitude, float)
    if size.shape not in ((), (1,), (len(axes),)) or not np.isfinite(size).all() or (size <= 0).any():
        problem = f"amplitudes {np.atleast_1d(size).tolist()} for {len(axes)} axes"
        raise InputError(problem, column="amplitude", remedy="give one positive number, or one per axis")
    time = np.arange(round(duration_s * rate_hz)) / rate_hz
    wave = np.sin(_phase(time, f_min_hz, f_max_hz, duration_s, sweep))
    return Design(
        name=name,
        kind="chirp",
        axes=tuple(axes),
        driven=driven,
        rate_hz=rate_hz,
        experiments=matrix.real[:, None, :] * wave[None, :, None] * size,
        lines=select_lines(f_min_hz, f_max_hz, len(time) / rate_hz),
        trials=name_trials(name, axes, matrix, 1),
        periods=periods,
        transient_periods=transient_periods,
        hold=tuple(float(x) for x in hold),
    )


def _phase(time: np.ndarray, f_min: float, f_max: float, duration: float, sweep: str) -> np.ndarray:
    """Return the phase of the sweep [rad]; its derivative is 2 pi times the frequency at each time."""
    if sweep == "linear":
        return 2 * np.pi * (f_min * time + 0.5 * (f_max - f_min) / duration * time**2)
    growth = duration / np.log(f_max / f_min)
    return 2 * np.pi * f_min * growth * np.expm1(time / growth)
