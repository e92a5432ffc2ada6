"""Measurement, closed chain and serial variants in one picture: magnitude, phase and error."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from workbench.core.palette import COLOURS, LINES
from workbench.report.response import words_of

from .responses import FrfComparison

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_STYLE = {name: line.drawn() for name, line in LINES.items()}
_DOTS, _BAND = COLOURS["quiet"][0], COLOURS["rule"][0]


def frf_figure(comparison: FrfComparison) -> Figure:
    """Response and models at one posture, a column per entry: magnitude with 95 % band, phase, error."""
    from workbench.core.picture import Picture  # slow to import, and only pictures need it

    frf = comparison.frf
    ny, nu = frf.response.shape[1:]
    figure = Picture(figsize=(2.9 * ny * nu + 0.9, 6.6), layout="constrained")
    grid = figure.add_gridspec(3, ny * nu, height_ratios=(1.3, 1.0, 1.0))
    for column, (i, j) in enumerate(np.ndindex(ny, nu)):
        magnitude, phase = figure.add_subplot(grid[0, column]), figure.add_subplot(grid[1, column])
        _magnitude(magnitude, comparison, i, j)
        _phase(phase, comparison, i, j)
        unit = f"{frf.outputs[i].unit} per {frf.inputs[j].unit}"
        magnitude.set_title(
            f"{frf.outputs[i].axis} over {frf.inputs[j].axis}\n[{unit}]", fontsize=9, loc="left"
        )
        if column == 0:
            magnitude.set_ylabel("magnitude")
            phase.set_ylabel("phase [deg]")
            magnitude.legend(frameon=False, fontsize=7.5, loc="lower left")
    _errors(figure.add_subplot(grid[2, :]), comparison)
    return figure


def _magnitude(ax: Axes, c: FrfComparison, i: int, j: int) -> None:
    f, size, std = c.frf.frequency, np.abs(c.frf.response[:, i, j]), c.frf.std[:, i, j]
    ax.fill_between(
        f,
        np.maximum(size - 1.96 * std, 0.02 * size),
        size + 1.96 * std,
        color=_BAND,
        lw=0,
        label="95 % interval",
    )
    ax.plot(f, size, ".", ms=2.2, color=_DOTS, label="measured")
    for name in c.models:
        ax.plot(f, np.abs(c.models[name][:, i, j]), label=words_of(name), **_STYLE.get(name, {}))
    ax.set_xscale("log")
    ax.set_yscale("log")
    _plain(ax)


def _phase(ax: Axes, c: FrfComparison, i: int, j: int) -> None:
    f = c.frf.frequency
    # where noise rules, a phase means nothing and an unwrapped one jumps by whole turns
    sure = c.frf.std[:, i, j] < 0.5 * np.abs(c.frf.response[:, i, j])
    ax.plot(f[sure], np.degrees(np.angle(c.frf.response[sure, i, j])), ".", ms=2.2, color=_DOTS)
    for name in c.models:
        angle = np.degrees(np.angle(c.models[name][:, i, j]))
        jump = np.abs(np.diff(angle, prepend=angle[0])) > 180
        ax.plot(f, np.where(jump, np.nan, angle), **_STYLE.get(name, {}))
    ax.set_xscale("log")
    ax.set_ylim(-185, 185)
    ax.set_yticks([-180, -90, 0, 90, 180])
    _plain(ax)


def _errors(ax: Axes, c: FrfComparison) -> None:
    f = c.frf.frequency
    ax.fill_between(f, 1e-4, 100.0 * c.noise, color=_BAND, lw=0, label="uncertainty of the measurement")
    for name in c.models:
        ax.plot(f, 100.0 * c.error[name], label=words_of(name), **_STYLE.get(name, {}))
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_ylim(max(0.05, 50.0 * float(np.min(c.noise))), None)
    ax.set_ylabel("relative error [%]")
    ax.set_xlabel("frequency [Hz]")
    ax.legend(frameon=False, fontsize=7.5, ncols=3)
    _plain(ax)


def _plain(ax: Axes) -> None:
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    ax.tick_params(labelsize=8)
