"""The state at the start of a recording: as stated, or as its first rows show it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import Controller, Recording
from workbench.recordings.noise import position_levels

_NONE = 1e-12  # rad or m: less noise than any
_CLEARLY = 6.0  # times its noise: what is elsewhere
_CHANCE = 3.0  # deviations of a rate that are none
_FEWEST, _MOST = 2, 4  # degrees of polynomials through a few rows
_LATE = 2.0  # ticks after which a loop at rest may begin to move what it drives
_AS_NOISE = 1.5  # times the noise, that few rows scatter by


def initial_state(
    recording: Recording,
    controller: Controller,
    reference: np.ndarray | None,
    to_actuator: np.ndarray,
    j: np.ndarray,
) -> np.ndarray:
    """Return the initial (q_s, rate), (2, n): at rest at the first reference, unless first rows differ.

    Args:
        recording: what is replayed.
        controller: its loop.
        reference: (N, n) in the controller's coordinates, None without one.
        to_actuator: (n, n), recording coordinates to actuator coordinates for positions.
        j: (n, n), q_p = J q_s.
    """
    back = np.linalg.inv(j)
    t, q, noise = _first_rows(recording)
    moving, *others = _polynomials(t, q, noise)
    held = reference is not None and controller.kind not in ("none", "unknown")
    if reference is None or not (held and recording.timing.initial_at_rest):
        return moving.start @ (back @ to_actuator).T
    first, doubt = _where_it_may_rest(q, noise, moving, others, controller.period_s or 0.0)
    stated = reference[0] if controller.coordinates == "joint" else back @ reference[0]
    rest = np.stack([np.linalg.inv(to_actuator) @ j @ stated, np.zeros_like(stated)])
    if (np.abs(first - rest) > _CLEARLY * doubt).any():
        return first @ (back @ to_actuator).T
    return np.stack([stated, np.zeros_like(stated)])


def doubt_of_start(recording: Recording) -> np.ndarray:
    """Return how far off a first position and rate may be that the first rows tell, (2, n), one deviation."""
    t, q, noise = _first_rows(recording)
    moving, *_ = _polynomials(t, q, noise)
    return moving.spread[:, None] * np.maximum(moving.scatter, noise)


def _first_rows(recording: Recording) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times (R,) and positions (R, n) of the first rows, and the noise of these (n,)."""
    rows = int(np.clip(0.02 / recording.period, 8, len(recording) // 2))
    noise = np.maximum(position_levels(recording)[1], _NONE)
    return recording.time[:rows] - recording.time[0], recording.position[:rows], noise


def _where_it_may_rest(
    q: np.ndarray, noise: np.ndarray, moving: _Polynomial, others: Sequence[_Polynomial], tick: float
) -> tuple[np.ndarray, np.ndarray]:
    """Position and rate at the first row and how far off they may be, (2, n) each.

    The rate is none wherever that does as well: one of its own is known to its noise only. So it is where it
    is no more than what a loop that begins late makes it seem: a `tick` [s] to compute, and one of delay.
    Where motion is no polynomial, rows are too far apart to tell a rate.
    """
    if not others:
        return np.stack([q[0], np.zeros_like(noise)]), np.stack([noise, noise])
    resting, further = others
    level = np.maximum(moving.scatter, noise)
    # how far the motion is from this polynomial shows in what the next one says
    bent = np.abs(further.start - moving.start)
    doubt = moving.spread[:, None] * level + [level, np.zeros_like(level)] + bent
    clear = resting.squares - moving.squares > (_CHANCE * level) ** 2
    if (clear & (np.abs(moving.start[1]) > _LATE * tick * np.abs(moving.bend))).any():
        return moving.start, doubt
    # at rest the first row says as much, and no polynomial bends it
    return np.stack([q[0], np.zeros_like(noise)]), doubt


@dataclass(frozen=True)
class _Polynomial:
    """Through some rows: value and rate at the first (2, n), by how much more these scatter than a row (2,),
    acceleration there, squares that are left and the level of these (n,).
    """

    start: np.ndarray
    spread: np.ndarray
    bend: np.ndarray
    squares: np.ndarray
    scatter: np.ndarray


def _polynomials(t: np.ndarray, q: np.ndarray, noise: np.ndarray) -> Iterator[_Polynomial]:
    """The shortest that leaves no more than noise, the same without a rate, and the next one.

    Where none does, nothing but the longest.
    """
    degrees = range(_FEWEST, max(min(_MOST, len(t) - 3), _FEWEST) + 1)
    tried = [_polynomial(t, q, range(degree + 1)) for degree in degrees]
    fits = [bool((each.scatter <= _AS_NOISE * noise).all()) for each in tried]
    if not any(fits):
        yield tried[-1]
        return
    which = fits.index(True)
    degree = degrees[which]
    yield tried[which]
    yield _polynomial(t, q, [k for k in range(degree + 1) if k != 1])
    yield _polynomial(t, q, range(degree + 2))


def _polynomial(t: np.ndarray, position: np.ndarray, powers: Sequence[int]) -> _Polynomial:
    basis = np.stack([(t / t[-1]) ** k for k in powers], axis=1)
    solution, *_ = np.linalg.lstsq(basis, position, rcond=None)
    squares = np.sum((position - basis @ solution) ** 2, axis=0)
    scatter = np.sqrt(squares / (len(t) - len(powers)))
    scale = np.array([1.0, 1.0 / t[-1]])
    spread = np.sqrt(np.diag(np.linalg.inv(basis.T @ basis)))[:2] * scale
    bend = 2.0 * solution[list(powers).index(2)] / t[-1] ** 2
    return _Polynomial(solution[:2] * scale[:, None], spread, bend, squares, scatter)
