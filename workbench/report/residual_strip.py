"""The residual before and after as two small drawings without a script, at the top of a page."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from workbench.core import Comparison, RecordingError

from .numbers import handy, number, plain, short
from .pack import partner, worst_view
from .residuals import Signal, column, compared, has, min_max, noise, rmse, units

#: Size of the drawing's own coordinates; the page stretches it.
WIDTH, HEIGHT = 1000, 100
_STRETCHES = 450


@dataclass(frozen=True)
class Strip:
    """One residual over time.

    Attributes:
        label: whose.
        size: its root mean square, with unit.
        style: ``"before"`` or ``"after"``, as the style sheet has it.
        path: of an SVG of `WIDTH` by `HEIGHT`, zero in the middle.
    """

    label: str
    size: str
    style: str
    path: str


@dataclass(frozen=True)
class Strips:
    """The residual of one signal with several models, at the same scale.

    Attributes:
        title: which signal of which axis, in which recording.
        strips: top first.
        band: half the height of twice the noise, in the drawing's coordinates; None where it is not known.
        noise: twice the noise, with unit; empty where it is not known.
        scale: what the drawing's half height is, with unit.
        duration: of the recording, with unit.
    """

    title: str
    strips: tuple[Strip, ...]
    band: float | None
    noise: str
    scale: str
    duration: str


def residual_strips(before: Comparison | None, after: Comparison | None) -> Strips | None:
    """Return the residual where the given model is worst, and the same place with the effects added.

    Args:
        before: the model as given against its recordings.
        after: the same recordings with the effects added; None where nothing was added.

    Returns:
        None where nothing was compared over time.
    """
    if before is None or not (before.recordings and before.axes):
        return None
    index, axis = worst_view(before)
    entry = before.recordings[index]
    k, name = column(entry, axis), _worst_signal(before, entry, axis)
    if k is None or name is None:
        return None
    later = partner(after, before, index)
    runs = [("before", entry, "Model as given")]
    if later is not None and has(later, name):
        runs.append(("after", later, "With the effects added"))
    unit = units(before, axis)[0 if name == "position" else 1]
    half = _half(runs[0][1], name, k)
    if not half:
        return None
    floor = 2.0 * noise(entry, name, k)
    factor, small = handy([half], unit)
    signal = "position" if name == "position" else "torque"
    return Strips(
        title=f"Residual {signal} of {plain(axis)} in {plain(entry.recording.name)}",
        strips=tuple(
            Strip(label, f"{number(factor * rmse(run, name, k))} {small}", style, _path(run, name, k, half))
            for style, run, label in runs
        ),
        band=min(1.0, floor / half) * HEIGHT / 2 if math.isfinite(floor) else None,
        noise=f"{number(factor * floor, 2)} {small}" if math.isfinite(floor) else "",
        scale=f"{number(factor * half, 2)} {small}",
        duration=f"{short(entry.recording.duration)} s",
    )


def _worst_signal(comparison: Comparison, entry: RecordingError, axis: str) -> Signal | None:
    """The signal with the largest excess on the axis; else the first that was compared."""
    names: tuple[Signal, ...] = ("torque_measured", "position")
    there: list[Signal] = [n for n in names if has(entry, n)]
    kind = {"torque": "torque_measured"}
    for share in sorted(comparison.where, key=lambda s: -s.share):
        signal = kind.get(share.signal, share.signal)
        if share.axis == axis and signal in there:
            return "position" if signal == "position" else "torque_measured"
    return there[0] if there else None


def _half(entry: RecordingError, name: Signal, k: int) -> float:
    """Half the height of the drawing: it holds all but the rarest values."""
    values = np.abs(compared(entry, name)[:, k])
    values = values[np.isfinite(values)]
    return 1.05 * float(np.quantile(values, 0.999)) if len(values) else 0.0


def _path(entry: RecordingError, name: Signal, k: int, half: float) -> str:
    """The residual as an SVG path; broken where nothing was compared, cut at the edges."""
    values = compared(entry, name)[:, k]
    finite = np.isfinite(values)
    thin, stride = min_max(np.where(finite, values, 0.0), _STRETCHES)
    at = np.minimum(np.arange(len(thin)) * stride, len(values) - 1)
    there = finite[at.astype(int)]
    x = at / max(len(values) - 1, 1) * WIDTH
    y = HEIGHT / 2 * (1.0 - np.clip(thin / half, -1.0, 1.0))
    parts, pen = [], "M"
    for here, a, b in zip(there, x, y, strict=True):
        if here:
            parts.append(f"{pen}{a:.1f} {b:.1f}")
        pen = "L" if here else "M"
    return "".join(parts)
