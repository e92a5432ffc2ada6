"""Figures for paper and screen: each says one thing, has units on its axes, and survives a grey printer."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullFormatter, NullLocator

from workbench.core import Comparison, InputError, Result
from workbench.core.picture import Picture, printed

from .ladder import log_axis, rungs
from .numbers import handy, number, plain
from .pack import partner
from .residuals import (
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
)
from .style import AFTER, BEFORE, FLOOR, INK, LOOKS, QUIET, house_style


def overlay_figure(
    comparison: Comparison,
    axis: str,
    *,
    recording: int = 0,
    after: Comparison | None = None,
    window: tuple[float, float] | None = None,
) -> Figure:
    """Return a figure: measured over simulated against time, the residual in a band of twice the noise.

    Args:
        comparison: the model as given.
        axis: which axis.
        recording: which entry of ``comparison.recordings``.
        after: the same recordings with the effects added.
        window: from when to when [s]; the whole recording if not given (see `worst_window`).
    """
    entry = comparison.recordings[recording]
    later = partner(after, comparison, recording)
    k = column(entry, axis)
    if k is None:
        raise InputError(f"recording '{plain(entry.recording.name)}' has no axis '{plain(axis)}'")
    shown = [
        (n, label, u) for (n, label), u in zip(SIGNALS, units(comparison, axis), strict=True) if has(entry, n)
    ]
    with house_style():
        figure, axes = _grid(2 * len(shown), 1, (7.2, 1.0 + 2.5 * len(shown)), heights=[2, 1.2] * len(shown))
        for row, (name, label, unit) in enumerate(shown):
            top, bottom = axes[2 * row, 0], axes[2 * row + 1, 0]
            runs = [("before", entry)] + (
                [("after", later)] if later is not None and has(later, name) else []
            )
            measured, dt = entry.recording.signals[name][:, k], entry.recording.period
            _curve(top, dt, window, measured, "measured", "measured")
            factor, small = handy([rmse(entry, name, k)], unit)
            for when, run in runs:
                text = {"before": "simulated", "after": "simulated, effects added"}[when]
                _curve(top, dt, window, run.simulated.signals[name][:, k], when, text)
                _curve(bottom, dt, window, factor * run.residual(name)[:, k], when, "")
            floor = 2 * factor * noise(entry, name, k)
            if np.isfinite(floor):
                bottom.axhspan(-floor, floor, color=FLOOR, alpha=0.3, lw=0, zorder=0, label="± 2 × noise")
                for edge in (-floor, floor):
                    bottom.axhline(edge, color=INK, lw=0.7, ls=(0, (1, 2)), zorder=5)
            top.set_ylabel(f"{label} [{unit}]")
            bottom.set_ylabel(f"residual [{small}]")
        for a in axes[:, 0]:
            a.sharex(axes[0, 0])
            a.margins(x=0)
        for a in axes[:-1, 0]:
            a.tick_params(labelbottom=False)
        axes[-1, 0].set_xlabel("time [s]")
        _head(figure, f"{printed(axis)}, recording {printed(entry.recording.name)}")
        figure.align_ylabels()
    return figure


def residual_figure(comparison: Comparison, axis: str, *, after: Comparison | None = None) -> Figure:
    """Return a figure: residual against speed and position; median of each bin, quartiles as a band."""
    quantities: tuple[tuple[Literal["speed", "position"], str], ...] = (("speed", "/s"), ("position", ""))
    with house_style():
        shown = _compared(comparison, axis)
        figure, axes = _grid(len(shown), 2, (7.2, 0.7 + 2.2 * len(shown)), sharey="row")
        for row, (name, label, unit) in enumerate(shown):
            factor, small = handy([_worst(comparison, axis, name)], unit)
            for col, (against, per) in enumerate(quantities):
                a = axes[row, col]
                a.axhline(0, color=QUIET, lw=0.6)
                for when, run in _runs(comparison, after):
                    b = binned(run, axis, name, against)
                    style = LOOKS[when] | {"marker": "o" if when == "before" else "s", "ms": 3}
                    a.fill_between(
                        b.centre, factor * b.low, factor * b.high, color=style["color"], alpha=0.18, lw=0
                    )
                    text = {"before": "model as given", "after": "effects added"}[when]
                    a.plot(b.centre, factor * b.median, label=text, **style)
                a.set_xlabel(f"{against} [{units(comparison, axis)[0]}{per}]")
            axes[row, 0].set_ylabel(f"{label} residual [{small}]")
        _head(figure, f"{printed(axis)}: residual, median and quartiles")
    return figure


def spectrum_figure(comparison: Comparison, axis: str, *, after: Comparison | None = None) -> Figure:
    """Return a figure: spectrum of the residual, and of the noise floor as white noise."""
    with house_style():
        shown = _compared(comparison, axis)
        figure, axes = _grid(1, len(shown), (7.2, 2.9))
        for a, (name, label, unit) in zip(axes[0], shown, strict=True):
            for when, run in _runs(comparison, after):
                f, density = spectrum(run, axis, name)
                text = {"before": "model as given", "after": "effects added"}[when]
                a.loglog(f, density, label=text, **LOOKS[when])
            floor = noise_density(comparison, axis, name)
            if np.isfinite(floor) and floor > 0:
                a.axhline(floor, color=FLOOR, lw=1.6, ls=(0, (1, 1.2)), label="noise floor, as white noise")
            a.set_xlabel("frequency [Hz]")
            a.set_ylabel(f"{label} residual [{unit}/√Hz]")
        _head(figure, f"{printed(axis)}: spectrum of the residual")
    return figure


def ladder_figure(result: Result) -> Figure:
    """Return a figure: the error of every step and the noise floor, on a log axis."""
    steps = rungs(result)
    floor = result.noise_error
    held_floor = None if isinstance(result, Comparison) else result.holdout_noise_error
    scale = log_axis([floor, held_floor, *(r.error for r in steps), *(r.holdout for r in steps)])
    with house_style():
        figure, axes = _grid(1, 1, (7.2, 1.4 + 0.42 * len(steps)))
        a = axes[0, 0]
        rows = np.arange(len(steps))
        a.axvspan(scale.low, floor, color=FLOOR, alpha=0.18, lw=0)
        a.axvline(floor, color=FLOOR, lw=1.6, ls=(0, (1, 1.2)), label=f"noise floor {number(floor)}")
        a.plot([r.error for r in steps], rows, "-o", color=AFTER, ms=6, lw=1.2, label="error")
        held = [(r.holdout, i) for i, r in enumerate(steps) if r.holdout is not None]
        if held:
            x, y = zip(*held, strict=True)
            a.plot(x, y, "--D", color=BEFORE, mfc="white", ms=5, lw=1.0, label="error on held-out data")
        if held and held_floor is not None:
            label = f"its noise floor {number(held_floor)}"
            a.axvline(held_floor, color=BEFORE, lw=1.2, ls=(0, (1, 2.4)), label=label)
        a.set_xscale("log")
        a.set(
            xlim=(scale.low, scale.high),
            ylim=(len(steps) - 0.5, -0.5),
            xlabel="error (RMSE / deviation of the signal)",
        )
        a.xaxis.set_major_locator(FixedLocator(list(scale.ticks)))
        a.xaxis.set_minor_locator(NullLocator())
        a.xaxis.set_minor_formatter(NullFormatter())
        a.set_xticks(list(scale.ticks), [number(t, 1) for t in scale.ticks])
        a.set_yticks(rows, [printed(r.label) for r in steps], color=INK)
        a.grid(axis="y", visible=False)
        _head(figure, "The error, step by step")
    return figure


def _grid(
    rows: int, cols: int, size: tuple[float, float], heights: list[float] | None = None, **kwargs: Any
) -> tuple[Figure, np.ndarray]:
    figure = Picture(figsize=size, layout="constrained")
    return figure, figure.subplots(rows, cols, squeeze=False, height_ratios=heights, **kwargs)


def _curve(
    a: Axes, dt: float, window: tuple[float, float] | None, values: np.ndarray, when: str, label: str
) -> None:
    first, last = (round(t / dt) for t in window) if window else (0, len(values))
    thin, stride = min_max(np.asarray(values[first : last + 1], float), 1200)
    a.plot(dt * (first + stride * np.arange(len(thin))), thin, label=label or None, **LOOKS[when])


def _runs(comparison: Comparison, after: Comparison | None) -> list[tuple[str, Comparison]]:
    return [("before", comparison)] + ([("after", after)] if after is not None else [])


def _compared(comparison: Comparison, axis: str) -> list[tuple[Signal, str, str]]:
    """The signals of an axis that some recording has: signal, name in print, unit."""
    entries = [e for e in comparison.recordings if column(e, axis) is not None]
    return [
        (n, label, unit)
        for (n, label), unit in zip(SIGNALS, units(comparison, axis), strict=True)
        if any(has(e, n) for e in entries)
    ]


def _worst(comparison: Comparison, axis: str, name: str) -> float:
    pairs = [(e, column(e, axis)) for e in comparison.recordings]
    return max(
        (rmse(e, name, k) for e, k in pairs if k is not None and np.isfinite(rmse(e, name, k))), default=1.0
    )


def _head(figure: Figure, title: str) -> None:
    """Title and one legend for all panels, above them, from the left."""
    entries = {}
    for a in figure.axes:
        handles, labels = a.get_legend_handles_labels()
        entries |= dict(zip(labels, handles, strict=True))
    figure.legend(
        entries.values(),
        entries.keys(),
        loc="outside upper left",
        ncols=4,
        title=title,
        title_fontsize=10,
        alignment="left",
    )
