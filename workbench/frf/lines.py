"""Which harmonics of a period are excited: every one, odd ones, odd ones with some left out to listen on.

On an odd grid, even nonlinearities answer at even lines only, where nothing was excited. Odd ones answer at
odd lines, so that one odd line of every group is left out at random: what appears there is distortion.
R. Pintelon and J. Schoukens, "System Identification: A Frequency Domain Approach", 2nd ed. 2012, ch. 4
(detection lines) and ch. 5 (choice of the grid).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from workbench.core import InputError

Grid = Literal["full", "odd", "odd_random"]

_GROUP = 4  # consecutive odd lines of which one stays silent


def select_lines(
    f_min_hz: float,
    f_max_hz: float,
    period_s: float,
    *,
    grid: Grid = "full",
    per_decade: int | None = None,
    seed: int = 0,
) -> np.ndarray:
    """Return the harmonic numbers of the excited lines, ascending; line k is at k / period_s.

    Args:
        f_min_hz, f_max_hz: band [Hz], both ends included.
        period_s: period of the excitation [s].
        grid: ``"full"``, ``"odd"``, or ``"odd_random"`` (of each four consecutive odd lines one, drawn
            with `seed`, stays silent).
        per_decade: lines per decade of a quasi-logarithmic choice from the grid; None takes them all.
        seed: draws the silent lines.

    Returns:
        Shape (F,), int.

    Raises:
        InputError: numbers that make no band, or a band without a line.
    """
    if not (np.isfinite(period_s) and period_s > 0):
        raise InputError(f"a period of {period_s:g} s", column="period_s", remedy="give a positive period")
    if not (np.isfinite(f_min_hz) and np.isfinite(f_max_hz) and 0 < f_min_hz <= f_max_hz):
        problem = f"a band from {f_min_hz:g} to {f_max_hz:g} Hz"
        raise InputError(problem, column="f_min_hz", remedy="give 0 < f_min_hz <= f_max_hz")
    if per_decade is not None and per_decade < 1:
        raise InputError(f"{per_decade} lines per decade", column="per_decade", remedy="give one or more")
    first = int(np.ceil(f_min_hz * period_s * (1 - 1e-9)))
    last = int(np.floor(f_max_hz * period_s * (1 + 1e-9)))
    lines = np.arange(max(first, 1), last + 1)
    lines = lines if grid == "full" else lines[lines % 2 == 1]
    if per_decade is not None and len(lines):
        lines = _quasi_logarithmic(lines, per_decade)
    if grid == "odd_random":
        lines = _leave_out(lines, seed)
    if len(lines) == 0:
        raise InputError(
            f"no {grid} line between {f_min_hz:g} and {f_max_hz:g} Hz in a period of {period_s:g} s",
            column="period_s", remedy="lengthen the period or widen the band",
        )  # fmt: skip
    return lines


def detection_lines(lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the lines of the band that were not excited on purpose: odd ones, even ones.

    Args:
        lines: excited harmonics, shape (F,).

    Returns:
        ``(odd, even)``, each ascending; both empty where even lines were excited, since a quadratic
        distortion then falls on any line.
    """
    nothing = np.zeros(0, int)
    if len(lines) == 0 or (lines % 2 == 0).any():
        return nothing, nothing
    silent = np.setdiff1d(np.arange(max(lines[0] - 1, 2), lines[-1] + 2), lines)
    return silent[silent % 2 == 1], silent[silent % 2 == 0]


def _quasi_logarithmic(lines: np.ndarray, per_decade: int) -> np.ndarray:
    """Return the lines of the grid nearest to a geometric series, each once."""
    decades = np.log10(lines[-1] / lines[0])
    wanted = np.geomspace(lines[0], lines[-1], max(2, round(decades * per_decade) + 1))
    above = np.clip(np.searchsorted(lines, wanted), 1, max(len(lines) - 1, 1))
    if len(lines) == 1:
        return lines
    nearer = wanted - lines[above - 1] < lines[above] - wanted
    return np.unique(lines[above - nearer])


def _leave_out(lines: np.ndarray, seed: int) -> np.ndarray:
    """Return the lines without one, drawn at random, of every complete group of consecutive lines."""
    whole = len(lines) // _GROUP * _GROUP
    places = np.random.default_rng(seed).integers(0, _GROUP, whole // _GROUP)
    silent = np.arange(0, whole, _GROUP) + places
    return np.delete(lines, silent)
