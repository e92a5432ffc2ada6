"""Encoders that wrap: positions that jump between the ends of their range, made continuous."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

_JUMP = 0.5  # of the range; no machine moves so far from row to row
_MOVES = 0.4  # of the range, which all other steps have to stay below
_NEAR = 0.01  # of the range, besides three steps, within which a jump starts and lands at its ends
_STRANGE = 3  # jumps alike from which a range is believed that no encoder is known to have
_EXACT = 1e-3  # of a range, to which it is seen
_VALUES = 16  # different numbers that a position has at least, and a switch has not
_FOLLOWS = 0.4  # of a range, within which a position that wraps stays near its reference
_AT_ONCE = 0.1  # the same of one that was not seen to wrap

_TURN = 2.0 * np.pi
#: Ranges of encoders and drives [rad]: turns, and what drives report over CAN (12.5 and 95.5 either way).
RANGES = (*(_TURN * 2.0**k for k in range(-1, 8)), 25.0, 191.0)
#: The same as logs have them: degrees, turns, counts, tenths, hundredths and thousandths.
RAW_RANGES = (
    *RANGES, *(360.0 * 2.0**k for k in range(-1, 4)), 3600.0, 36000.0, 360000.0, 1.0, 2.0, 100.0, 200.0,
    *(2.0**k for k in range(8, 33)), 1000.0 * _TURN,
)  # fmt: skip


@dataclass(frozen=True)
class Wrap:
    """How a position wraps: its range, and the rows (K,) after its jumps."""

    range: float
    rows: np.ndarray


def wrap_of(position: np.ndarray, ranges: Sequence[float] = RANGES) -> Wrap | None:
    """Return the wrap of an encoder; None if the position has none.

    Args:
        position: shape (N,), finite.
        ranges: those that are known, in the position's unit; another one is believed from three jumps on.
    """
    span = float(np.ptp(position)) if len(position) else 0.0
    if span == 0.0 or len(np.unique(position)) < _VALUES:
        return None
    steps = np.diff(position)
    jumps = np.abs(steps) > _JUMP * span
    at = [int(k) for k in np.flatnonzero(jumps)]
    if not len(at) or jumps.mean() > 0.25 or np.abs(steps[~jumps]).max() > _MOVES * span:
        return None
    beside = np.array([_step_beside(steps, jumps, k) for k in at])
    near = _NEAR * span + 3.0 * np.abs(beside)
    low, high = position.min(), position.max()
    up, rows = steps[at] > 0, np.array(at) + 1
    start, end = position[at], position[rows]
    ends = np.where(up, np.maximum(start - low, high - end), np.maximum(high - start, end - low))
    if (ends > near).any():
        return None
    whole = np.abs(steps[at] - beside)
    size, typical = float(np.median(whole)), float(np.median(np.abs(steps[~jumps])))
    nearest = min(ranges, key=lambda known: abs(known - size))
    if abs(nearest - size) <= max(_EXACT * size, 2.0 * typical):
        return Wrap(nearest, rows)
    return Wrap(size, rows) if len(at) >= _STRANGE and np.ptp(whole) <= near.max() else None


def unwrapped(position: np.ndarray, wrap: Wrap) -> np.ndarray:
    """Return a position (N,) with its jumps undone; its first value is unchanged."""
    turns = np.zeros(len(position))
    turns[wrap.rows] = -np.sign(position[wrap.rows] - position[wrap.rows - 1])
    return position + wrap.range * np.cumsum(turns)


def unwrap(
    signals: Mapping[str, np.ndarray],
    good: np.ndarray,
    axes: Sequence[str],
    turning: Sequence[bool],
    *,
    referred: bool = True,
) -> tuple[dict[str, np.ndarray], tuple[str, ...]]:
    """Return signals with positions continuous and moved by whole ranges to references, and notes on it.

    Args:
        signals: name -> (N, n), SI.
        good: rows that were measured, (N,) bool.
        axes: their names.
        turning: which of them turn.
        referred: whether references are in the coordinates of the positions.
    """
    out, notes = {name: np.array(x) for name, x in signals.items()}, []
    for i in [i for i, turns in enumerate(turning) if turns]:
        for name in [name for name in ("position", "link_position") if name in out]:
            x = out[name][good, i]
            wrap = wrap_of(x) if np.isfinite(x).all() else None
            size = _TURN if wrap is None else wrap.range
            whole = x if wrap is None else unwrapped(x, wrap)
            asked = out["position_reference"][good, i] if referred and "position_reference" in out else None
            if wrap is not None and asked is not None and (other := wrap_of(asked, (size,))) is not None:
                asked = unwrapped(asked, other)
                out["position_reference"][good, i] = asked
            shift = (
                0.0 if asked is None else _whole_ranges(asked - whole, size, _FOLLOWS if wrap else _AT_ONCE)
            )
            if wrap is None and not shift:
                continue
            out[name][good, i] = whole + shift
            notes.append(_note(name.replace("_", " "), axes[i], wrap, shift))
    return (out, tuple(notes)) if notes else (dict(signals), ())


def _step_beside(steps: np.ndarray, jumps: np.ndarray, k: int) -> float:
    """Return the motion's own step at a jump: the mean of the nearest other steps."""
    around = [j for j in (k - 2, k - 1, k + 1, k + 2) if 0 <= j < len(steps) and not jumps[j]]
    return float(np.mean(steps[around])) if around else 0.0


def _whole_ranges(error: np.ndarray, size: float, near: float) -> float:
    """Return whole ranges between a position and the reference it follows; zero if it follows none."""
    if not np.isfinite(error).all() or not len(error):
        return 0.0
    shift = size * round(float(np.median(error)) / size)
    return shift if np.quantile(np.abs(error - shift), 0.9) < near * size else 0.0


def _note(what: str, axis: str, wrap: Wrap | None, shift: float) -> str:
    moved = f"moved by {shift:.4g} rad to its reference" if shift else ""
    if wrap is None:
        return f"{what.capitalize()} of '{axis}' is whole turns away from its reference: {moved}."
    times = "once" if len(wrap.rows) == 1 else f"{len(wrap.rows)} times"
    done = f"the jumps are undone{', and it is ' + moved if moved else ''}"
    return (
        f"{what.capitalize()} of '{axis}' jumps by its whole range of {wrap.range:.4g} rad {times}, as an "
        f"encoder that wraps does: {done}."
    )
