"""Data of all plots of a page, in a small form: curves as one compressed block, the rest as JSON values."""

from __future__ import annotations

from typing import Any

import numpy as np

from workbench.core import Comparison, Diagnosis, RecordingError, Result

from .numbers import handy, plain, rounded
from .residuals import (
    AGAINST,
    SIGNALS,
    Signal,
    binned,
    column,
    has,
    min_max,
    noise,
    noise_density,
    rmse,
    spectrum,
    units,
    worst_window,
)
from .shell import compress

#: Points of all curves together; about 1.7 bytes of page each.
_BUDGET = 1_100_000
#: Fewest points that a curve is thinned to, while there are recordings that can be left out.
_FEWEST = 4000
#: A curve is stored in steps of the noise, or of its own range, divided by these.
_STEPS_PER_NOISE, _STEPS_PER_RANGE = 12.0, 8000.0
_MAX_GAPS = 200


class _Block:
    """Curves as zigzag differences of 32-bit integers, byte planes apart, to suit gzip."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.size = 0

    def add(self, values: np.ndarray, step: float, dt: float, bins: int) -> dict[str, Any] | None:
        good = np.isfinite(values)
        if not good.any():
            return None
        values = np.where(good, values, values[good][0])
        thin, stride = min_max(values, bins)
        step = max(step, float(np.abs(thin).max()) / 2**29) or 1.0
        delta = np.diff(np.round(thin / step).astype(np.int64), prepend=0)
        zigzag = ((delta << 1) ^ (delta >> 63)).astype("<u4")
        planes = zigzag.view(np.uint8).reshape(-1, 4).T.tobytes()
        where = {"at": self.size, "n": len(thin), "step": step, "dt": dt * stride}
        self.parts.append(planes)
        self.size += len(planes)
        return where


def plots(before: Comparison, after: Comparison | None) -> tuple[dict[str, Any], str]:
    """Return the data of the plots.

    Args:
        before: the model as given against its recordings.
        after: the same recordings with the effects added, if there is such a thing.

    Returns:
        Plain values for JSON, and the curves that they point into, compressed.
    """
    shown, start = _choose(before, after), worst_view(before)
    curves = max(1, sum(len(before.recordings[i].recording.axes) for i in shown) * (10 if after else 6))
    bins = max(_FEWEST // 4, _BUDGET // curves // 2)
    block = _Block()
    views = []
    for i in shown:
        entry = before.recordings[i]
        views.append(
            {
                "name": plain(entry.recording.name),
                "duration": entry.recording.duration,
                "gaps": _gaps(entry),
                "axes": [_view(entry, partner(after, before, i), axis, block, bins) for axis in before.axes],
            }
        )
    out = {
        "recordings": views,
        "axes": [_axis(before, after, axis) for axis in before.axes],
        "after": after is not None,
        "left_out": len(before.recordings) - len(shown),
        "start": {"recording": shown.index(start[0]), "axis": before.axes.index(start[1])},
    }
    return out, compress(b"".join(block.parts))


def comparisons(result: Result) -> tuple[Comparison | None, Comparison | None]:
    """Return the comparisons of a result: with the model as given, and with the found effects, if any."""
    if isinstance(result, Comparison):
        return result, None
    added = result.findings if isinstance(result, Diagnosis) else result.steps
    return result.before, result.after if added else None


def partner(after: Comparison | None, before: Comparison, index: int) -> RecordingError | None:
    """Return the entry of `after` for the same recording as entry `index` of `before`."""
    if after is None:
        return None
    name = before.recordings[index].recording.name
    rows = len(before.recordings[index].recording)
    same = [e for e in after.recordings if e.recording.name == name and len(e.recording) == rows]
    return same[0] if same else None


def worst_view(comparison: Comparison) -> tuple[int, str]:
    """Return the recording with the largest error, and its axis with the largest error."""
    entries = comparison.recordings
    index = int(np.argmax([np.nan_to_num(e.error) for e in entries]))
    shared = [a for a in comparison.axes if a in entries[index].recording.axes] or list(comparison.axes)
    share = next(
        (s.axis for s in sorted(comparison.where, key=lambda s: -s.share) if s.axis in shared), shared[0]
    )
    return index, share


def _choose(before: Comparison, after: Comparison | None) -> list[int]:
    """The recordings that fit, those with the largest error if not all do, in their order."""
    per_recording = max(1, len(before.axes)) * (10 if after else 6)
    fit = max(1, _BUDGET // _FEWEST // per_recording)
    by_error = sorted(range(len(before.recordings)), key=lambda i: -np.nan_to_num(before.recordings[i].error))
    return sorted(by_error[:fit])


def _view(
    entry: RecordingError, later: RecordingError | None, axis: str, block: _Block, bins: int
) -> dict[str, Any] | None:
    k = column(entry, axis)
    if k is None:
        return None
    out: dict[str, Any] = {"window": worst_window(entry, axis)}
    dt = entry.recording.period
    for name, label in SIGNALS:
        if not has(entry, name):
            out[label] = None
            continue
        measured, floor = entry.recording.signals[name][:, k], noise(entry, name, k)
        span = float(np.nanmax(measured) - np.nanmin(measured)) / _STEPS_PER_RANGE
        step = floor / _STEPS_PER_NOISE if np.isfinite(floor) and floor > 0 else span
        runs = [("before", entry)] + ([("after", later)] if later is not None and has(later, name) else [])
        curves = {"measured": block.add(measured, step, dt, bins)}
        for when, run in runs:
            curves[when] = block.add(run.simulated.signals[name][:, k], step, dt, bins)
            curves[f"{when}_residual"] = block.add(run.residual(name)[:, k], step, dt, bins)
        out[label] = {
            "curves": curves,
            "noise": floor if np.isfinite(floor) else None,
            "rmse": {when: _finite(rmse(run, name, k)) for when, run in runs},
        }
    return out


def _axis(before: Comparison, after: Comparison | None, axis: str) -> dict[str, Any]:
    """Units, binned residuals and spectra of one axis, pooled over all recordings."""
    out: dict[str, Any] = {"name": plain(axis)}
    position_unit, torque = units(before, axis)
    for (name, label), unit in zip(SIGNALS, (position_unit, torque), strict=True):
        runs = [("before", before)] + ([("after", after)] if after is not None else [])
        spectra = {when: _density(run, axis, name) for when, run in runs}
        floor = noise_density(before, axis, name)
        sizes = [rmse(e, name, k) for e in before.recordings if (k := column(e, axis)) is not None]
        factor, small = handy([float(np.nanmax(sizes)) if np.isfinite(sizes).any() else 0.0], unit)
        out[label] = {
            "unit": unit,
            "residual_unit": small,
            "residual_factor": factor,
            "against": {q: {when: _bins(run, axis, name, q) for when, run in runs} for q in AGAINST[label]},
            "spectrum": spectra,
            "noise_density": _finite(floor),
        }
    out["speed_unit"] = f"{position_unit}/s"
    return out


def _bins(run: Comparison, axis: str, name: Signal, against: Any) -> dict[str, list[float | None]]:
    b = binned(run, axis, name, against)
    return {k: rounded(getattr(b, k)) for k in ("centre", "median", "low", "high")}


def _density(run: Comparison, axis: str, name: Signal) -> dict[str, list[float | None]]:
    f, a = spectrum(run, axis, name)
    return {"f": rounded(f), "a": rounded(a)}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _gaps(entry: RecordingError) -> list[list[float]]:
    """Start and end [s] of the stretches not measured or not compared; at most the first few hundred."""
    left_out = ~np.asarray(entry.recording.valid, bool)
    if has(entry, "torque_measured") and not has(entry, "position"):
        left_out |= (entry.residual("torque_measured") == 0.0).all(axis=1)
    bad = np.concatenate([[False], left_out, [False]])
    edges = np.flatnonzero(np.diff(bad.astype(int)))
    dt = entry.recording.period
    return [[float(a * dt), float((b - 1) * dt)] for a, b in edges.reshape(-1, 2)[:_MAX_GAPS]]
