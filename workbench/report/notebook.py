"""Results and recordings as a notebook shows them."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from functools import singledispatch
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from workbench.core import Comparison, Diagnosis, Recording
from workbench.core.palette import LINES
from workbench.core.picture import Picture
from workbench.core.units import torque_unit

from . import wording as w
from .answer import diagnosis_sentence
from .figures import house_style, ladder_figure, overlay_figure
from .numbers import interval, number, percent, plain, quantity
from .pack import worst_view
from .residuals import min_max, worst_window

_TRACES = (("position", "position"), ("torque_measured", "torque"))


@singledispatch
def as_html(value: Any) -> str:
    """A value in a few lines of HTML; strangers' strings are escaped."""
    return f"<pre>{html.escape(repr(value))}</pre>"


@singledispatch
def as_figure(value: Any, **options: Any) -> Figure:
    """A picture of what matters most."""
    raise TypeError(f"there is no picture of a {type(value).__name__}")


@as_html.register
def _(value: Comparison) -> str:
    rows = [
        (
            e.recording.name if k == 0 else "",
            axis,
            *(_beside(size[k], noise[k], unit) for size, noise, unit in (
                (e.position_rmse, e.position_noise, e.recording.units[k]),
                (e.torque_rmse, e.torque_noise, torque_unit(e.recording.units[k])),
            )),
        )
        for e in value.recordings
        for k, axis in enumerate(e.recording.axes)
    ]  # fmt: skip
    head = ("recording", "axis", "position RMSE (noise)", "torque RMSE (noise)")
    numbers = f"error {number(value.error)}, noise floor {number(value.noise_error)}"
    return _block(w.comparison_sentence(value), numbers, head, rows)


@as_html.register
def _(value: Diagnosis) -> str:
    rows = [
        (
            w.capital(w.effect_phrase(f.key)),
            "; ".join(f"{w.parameter_name(n)} {interval(e)}" for n, e in f.parameters.items()),
            percent(f.probability),
            number(f.error_after),
            "; ".join(w.effect_phrase(k) for k in f.indistinguishable_from) or "–",
        )
        for f in value.findings
    ]
    numbers = f"error {number(value.error)}, noise floor {number(value.noise_error)}"
    if value.next_experiment:
        numbers += f". Measure next: {value.next_experiment}"
    head = ("effect", "parameters (95 %)", "probable", "error with it", "looks the same")
    return _block(diagnosis_sentence(value), numbers, head, rows)


@as_html.register
def _(value: Recording) -> str:
    rows = [
        (axis, f"{number(float(np.nanmin(q)))} to {number(float(np.nanmax(q)))} {unit}")
        for axis, unit, q in zip(value.axes, value.units, value.position.T, strict=True)
    ]
    measured = ", ".join(s.replace("_", " ") for s in value.signals if s not in value.derived)
    told = (
        f"{number(value.duration)} s at {number(1.0 / value.period)} Hz, {value.coordinates} coordinates, "
        f"loop: {value.controller.kind}. Measured: {measured}."
    )
    return _block(value.name, told, ("axis", "range"), rows)


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
def _(value: Recording) -> Figure:
    """Position and torque of every axis against time."""
    names = [(n, label) for n, label in _TRACES if value.get(n) is not None]
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
                place.set_ylabel(f"{plain(axis)} {label} [{unit}]".replace("$", r"\$"))
                place.margins(x=0)
        axes[-1].set_xlabel("time [s]")
    return figure


def _beside(size: float, noise: float, unit: str) -> str:
    return f"{quantity(float(size), unit)} ({quantity(float(noise), unit)})"


def _block(title: str, told: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    body = "".join(f"<tr>{''.join(f'<td>{_safe(c)}</td>' for c in row)}</tr>" for row in rows)
    top = "".join(f"<th>{_safe(h)}</th>" for h in head)
    table = f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>" if body else ""
    return f"<div><p><strong>{_safe(title)}</strong><br>{_safe(told)}</p>{table}</div>"


def _safe(text: str) -> str:
    return html.escape(plain(text))
