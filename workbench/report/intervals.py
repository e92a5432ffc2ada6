"""Pictures of numbers with intervals: parameters of an effect, measures of a gait, checks of a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from workbench.core import Estimate, Finding, Step, Verification
from workbench.core.picture import Picture, printed
from workbench.core.units import unit_text
from workbench.gait import Gait, Interval

from .numbers import Z95
from .style import AFTER, BEFORE, FLOOR, INK, house_style
from .verification import quantity_name
from .wording import capital, effect_phrase, parameter_name


@dataclass(frozen=True)
class Mark:
    """A number and its 95 % interval (zero or infinitely wide where none is known), as one mark of a row."""

    name: str
    value: float
    low: float
    high: float
    colour: str = AFTER


@dataclass(frozen=True)
class Row:
    """Marks that share one scale: `label` says what they are, and their unit."""

    label: str
    marks: tuple[Mark, ...]


def intervals_figure(title: str, rows: Sequence[Row]) -> Figure:
    """Return a figure: below each other a scale for each row, with its marks; names of marks in a legend."""
    with house_style():
        figure = Picture(figsize=(7.2, 0.9 + 0.75 * len(rows)), layout="constrained")
        entries = {}
        for ax, row in zip(figure.subplots(len(rows), 1, squeeze=False)[:, 0], rows, strict=True):
            for k, mark in enumerate(row.marks):
                known = np.isfinite(mark.low) and np.isfinite(mark.high)
                reach = [[mark.value - mark.low], [mark.high - mark.value]] if known else None
                drawn = ax.errorbar(mark.value, -k, xerr=reach, fmt="o", ms=5, capsize=3, color=mark.colour)
                entries.setdefault(mark.name, drawn)
            ax.set(yticks=[], ylim=(0.5 - len(row.marks), 0.5))
            ax.set_ylabel(printed(row.label), rotation=0, ha="right", va="center")
        figure.legend(
            entries.values(), entries.keys(), loc="outside upper left", ncols=4, title=printed(title),
            title_fontsize=10, alignment="left",
        )  # fmt: skip
    return figure


def effect_figure(value: Finding | Step) -> Figure:
    """Return a figure of an effect's parameters with 95 % intervals, and of the errors with it."""
    rows = [Row(_label(parameter_name(n), e.unit), (_estimate(e),)) for n, e in value.parameters.items()]
    if isinstance(value, Finding):
        if value.total is not None and value.model_value is not None:
            old = value.model_value
            marks = _estimate(value.total), Mark("in the model as given", old, old, old, BEFORE)
            rows.append(Row(_label(value.number, value.total.unit), marks))
        errors = {"error with it": value.error_after, "on held-out data, before": value.holdout_error_before}
        errors["on held-out data, with it"] = value.holdout_error_after
    else:
        errors = {"error with it": value.error, "on held-out data, with it": value.holdout_error}
    colours = {"error with it": INK, "on held-out data, before": BEFORE, "on held-out data, with it": FLOOR}
    marks = tuple(Mark(n, x, x, x, colours[n]) for n, x in errors.items() if x is not None)
    return intervals_figure(capital(effect_phrase(value.key)), [*rows, Row("error", marks)])


def gait_figure(result: Gait) -> Figure:
    """Return a figure of every measure's gap, beside that of the hardware's second run if there is one."""

    def marks(gap: Interval, floor: Interval | None) -> tuple[Mark, ...]:
        again = () if floor is None else (Mark("hardware again", floor.value, floor.low, floor.high, FLOOR),)
        return (Mark("gap (95 %)", gap.value, gap.low, gap.high), *again)

    rows = [Row(_label(m.name, m.unit), marks(m.gap, m.floor)) for m in result.measures]
    return intervals_figure(f"{result.hardware} against {result.simulator}", rows)


def checks_figure(result: Verification) -> Figure:
    """Return a figure of every check's difference as a share of what is allowed, on a log axis."""
    names = [quantity_name(c.name) for c in result.checks]
    shares = [c.value / c.tolerance if c.tolerance else 0.0 if c.passed else np.inf for c in result.checks]
    rows = np.arange(len(names))
    with house_style():
        figure = Picture(figsize=(7.2, 1.1 + 0.24 * len(names)), layout="constrained")
        ax = figure.subplots()
        ax.axvline(1.0, color=INK, lw=1.2, ls=(0, (1, 2)))
        colours = [AFTER if c.passed else BEFORE for c in result.checks]
        ax.scatter(np.clip(shares, 1e-8, 1e3), rows, color=colours, s=22, zorder=3)
        ax.set(
            xscale="log", yticks=rows, yticklabels=list(map(printed, names)), ylim=(len(names) - 0.5, -0.5),
            xlabel="difference / largest difference allowed", title=printed(result.model),
        )  # fmt: skip
    return figure


def _estimate(e: Estimate) -> Mark:
    half = Z95 * e.std
    return Mark("estimate (95 %)", e.value, e.value - half, e.value + half)


def _label(name: str, unit: str) -> str:
    return f"{name} [{unit_text(unit)}]" if unit_text(unit) else name
