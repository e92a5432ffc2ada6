"""Results and recordings in a notebook."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import singledispatch
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from workbench.core import (
    Comparison,
    Diagnosis,
    Finding,
    Improvement,
    Recording,
    RecordingError,
    Recordings,
    Step,
    Verification,
)  # fmt: skip
from workbench.core.palette import LINES
from workbench.core.picture import Picture, printed
from workbench.core.shown import Row, Summary
from workbench.core.units import torque_unit
from workbench.gait import Gait

from . import gait, verification
from . import wording as w
from .answer import diagnosis_sentence, improvement_sentence, in_words
from .comparison_words import comparison_sentence
from .figures import ladder_figure, overlay_figure
from .intervals import checks_figure, effect_figure, gait_figure
from .numbers import number, percent, plain, quantity
from .pack import worst_view
from .residuals import SIGNALS, min_max, worst_window
from .style import house_style

_ERRORS = ("axis", "position RMSE (noise)", "torque RMSE (noise)")


@singledispatch
def summary(value: Any) -> Summary:
    """Return a value in a few lines, without control characters."""
    return Summary(type(value).__name__, "")


@singledispatch
def as_figure(value: Any, **options: Any) -> Figure:
    """Return the most important picture of a value."""
    raise TypeError(f"there is no picture of a {type(value).__name__}")


summary.register(Verification, verification.summary)
summary.register(Gait, gait.summary)
as_figure.register(Verification, checks_figure)
as_figure.register(Gait, gait_figure)
as_figure.register(Finding, effect_figure)
as_figure.register(Step, effect_figure)


@summary.register
def _(value: Comparison) -> Summary:
    rows = [
        (e.recording.name if k == 0 else "", *row)
        for e in value.recordings
        for k, row in enumerate(_errors(e))
    ]
    told = _error(value.error, value.noise_error)
    return _plain(comparison_sentence(value), told, ("recording", *_ERRORS), rows)


@summary.register
def _(value: RecordingError) -> Summary:
    return _plain(value.recording.name, _error(value.error, value.noise_error), _ERRORS, _errors(value))


@summary.register
def _(value: Finding) -> Summary:
    title = f"{w.capital(w.effect_phrase(value.key))}, {percent(value.probability)} probable"
    return _named(title, value, value.error_after)


@summary.register
def _(value: Step) -> Summary:
    return _named(w.capital(w.effect_phrase(value.key)), value, value.error)


@summary.register
def _(value: Diagnosis) -> Summary:
    rows = [
        (
            w.capital(w.effect_phrase(f.key)),
            "; ".join(in_words(f.parameters)),
            percent(f.probability),
            number(f.error_after),
            "; ".join(w.effect_phrase(k) for k in f.indistinguishable_from) or "–",
        )
        for f in value.findings
    ]
    told = _error(value.error, value.noise_error)
    if value.next_experiment:
        told += f". Measure next: {value.next_experiment}"
    head = ("effect", "parameters (95 %)", "probable", "error with it", "looks the same")
    return _plain(diagnosis_sentence(value), told, head, rows)


@summary.register
def _(value: Improvement) -> Summary:
    rows = [
        (f"+ {w.effect_phrase(s.key)}", "; ".join(in_words(s.parameters)), number(s.error))
        for s in value.kept
    ]
    told = _error(value.error_after, value.noise_error)
    return _plain(improvement_sentence(value), told, ("effect", "parameters (95 %)", "error with it"), rows)


@summary.register
def _(value: Recording) -> Summary:
    measured = ", ".join(s.replace("_", " ") for s in value.signals if s not in value.derived)
    told = (
        f"{_length(value)}, {value.coordinates} coordinates, loop: {value.controller.kind}. "
        f"Measured: {measured}."
    )
    return _plain(value.name, told, ("axis", "range"), [(axis, text) for axis, text in _ranges(value)])


@summary.register
def _(value: Recordings) -> Summary:
    rows = [(r.name, _length(r), "; ".join(f"{axis} {text}" for axis, text in _ranges(r))) for r in value]
    total = number(sum(r.duration for r in value))
    title = f"{len(value)} recording{'s' * (len(value) != 1)}, {total} s"
    return _plain(title, "", ("recording", "length", "ranges"), rows)


@as_figure.register
def _(value: Comparison, *, axis: str | None = None, recording: int | None = None) -> Figure:
    """Measured over simulated where the model fails most, or of another axis and recording."""
    worst, named = worst_view(value)
    index = worst if recording is None else recording
    chosen = named if axis is None else axis
    window = worst_window(value.recordings[index], chosen)
    return overlay_figure(value, chosen, recording=index, window=window)


@as_figure.register
def _(value: Diagnosis) -> Figure:
    """The error falling with every finding."""
    return ladder_figure(value)


@as_figure.register
def _(value: Improvement) -> Figure:
    """The error falling with every effect that was added."""
    return ladder_figure(value)


@as_figure.register
def _(value: RecordingError, *, axis: str | None = None) -> Figure:
    """Measured over simulated of the axis whose error is most above its noise, or of another one."""
    alone = Comparison("", value.recording.axes, (value,), value.error, value.noise_error, 0.0, False)
    ratios = np.fmax(value.position_rmse / value.position_noise, value.torque_rmse / value.torque_noise)
    worst = value.recording.axes[int(np.argmax(np.nan_to_num(ratios)))]
    return as_figure(alone, axis=worst if axis is None else axis)


@as_figure.register
def _(value: Recordings, *, recording: int = 0) -> Figure:
    """One of them, the first if not said."""
    return as_figure(value[recording])


@as_figure.register
def _(value: Recording) -> Figure:
    """Position and torque of every axis against time."""
    names = [(n, label) for n, label in SIGNALS if value.get(n) is not None]
    with house_style():
        figure = Picture(figsize=(7.2, 1.7 * len(names) * len(value.axes) + 0.4), layout="constrained")
        axes = figure.subplots(len(names) * len(value.axes), 1, sharex=True, squeeze=False)[:, 0]
        places = iter(axes)
        for k, axis in enumerate(value.axes):
            for name, label in names:
                place = next(places)
                thin, stride = min_max(value.signals[name][:, k], 1200)
                time = value.period * stride * np.arange(len(thin))
                place.plot(time, thin, color=LINES["measured"].light, lw=1.4)
                unit = value.units[k] if label == "position" else torque_unit(value.units[k])
                place.set_ylabel(printed(f"{axis} {label} [{unit}]"))
                place.margins(x=0)
        axes[-1].set_xlabel("time [s]")
    return figure


def _named(title: str, value: Finding | Step, error: float) -> Summary:
    """An effect with its parameters, the error with it, and what speaks for it."""
    told = "; ".join([*in_words(value.parameters), f"error with it {number(error)}"])
    if value.indistinguishable_from:
        told += f"; looks the same: {'; '.join(w.effect_phrase(k) for k in value.indistinguishable_from)}"
    return _plain(title, told, ("evidence",), [(line,) for line in value.evidence])


def _errors(e: RecordingError) -> Iterator[Row]:
    """Every axis with its errors beside their noise."""
    for k, (axis, unit) in enumerate(zip(e.recording.axes, e.recording.units, strict=True)):
        yield (
            axis,
            _beside(e.position_rmse[k], e.position_noise[k], unit),
            _beside(e.torque_rmse[k], e.torque_noise[k], torque_unit(unit)),
        )


def _beside(size: float, noise: float, unit: str) -> str:
    return f"{quantity(float(size), unit)} ({quantity(float(noise), unit)})"


def _plain(title: str, told: str, head: Row, rows: Iterable[Row]) -> Summary:
    table = [tuple(plain(cell) for cell in row) for row in rows]
    return Summary(plain(title), plain(told), [(head, table)])


def _error(error: float, floor: float) -> str:
    return f"error {number(error)}, noise floor {number(floor)}"


def _length(recording: Recording) -> str:
    return f"{number(recording.duration)} s at {number(1.0 / recording.period)} Hz"


def _ranges(recording: Recording) -> Iterator[tuple[str, str]]:
    """Every axis with its lowest and highest position."""
    for axis, unit, q in zip(recording.axes, recording.units, recording.position.T, strict=True):
        yield axis, f"{number(float(np.nanmin(q)))} to {number(float(np.nanmax(q)))} {unit}"
