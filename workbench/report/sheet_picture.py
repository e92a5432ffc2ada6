"""Panels of a page as a picture: for files, and for where scripts do not run."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from workbench.core.palette import COLOURS, LINES
from workbench.core.picture import Picture, printed

from .sheet import STYLES, Curve, Panel
from .style import house_style


def panels_figure(panels: Sequence[Panel]) -> Figure:
    """Return a figure: a column for each panel, its diagrams above each other, and wide panels below."""
    beside = [p for p in panels if not p.wide] or panels[:1]
    below = [p for p in panels if p not in beside]
    rows = max(len(p.rows) for p in beside)
    lines = rows + sum(len(p.rows) for p in below)
    with house_style():
        figure = Picture(figsize=(2.9 * max(2, len(beside)) + 0.9, 0.6 + 2.1 * lines), layout="constrained")
        grid = figure.add_gridspec(lines, len(beside))
        for k, panel in enumerate(beside):
            axes = [figure.add_subplot(grid[i, k]) for i in range(len(panel.rows))]
            _draw(axes, panel, named=k == 0)
        for panel in below:
            axes = [figure.add_subplot(grid[rows + i, :]) for i in range(len(panel.rows))]
            _draw(axes, panel, named=True)
            rows += len(panel.rows)
    return figure


def _draw(axes: Sequence[Axes], panel: Panel, *, named: bool) -> None:
    for ax, row in zip(axes, panel.rows, strict=True):
        for curve in row.curves:
            _curve(ax, curve)
        ax.set_xscale("log" if panel.log else "linear")
        ax.set_yscale("log" if row.log else "linear")
        if named or row is panel.rows[0]:  # whose unit is its own
            ax.set_ylabel(printed(row.label))
    axes[0].set_title(printed(panel.title))
    axes[-1].set_xlabel(printed(panel.x_label))
    if named:
        axes[0].legend(frameon=False, fontsize=7)


def _curve(ax: Axes, curve: Curve) -> None:
    name, shape, _ = STYLES.get(curve.style, STYLES["fit"])
    colour, label = COLOURS[name][0], printed(curve.name)
    if curve.low is not None and curve.high is not None:
        ax.fill_between(curve.x, curve.low, curve.high, color=colour, alpha=0.35, lw=0, label=label)
    elif curve.y is None:
        return
    elif shape == "dot":
        ax.plot(curve.x, curve.y, ".", ms=2.5, color=colour, label=label)
    elif curve.style == "limit":
        ax.plot(curve.x, curve.y, ls=(0, (1, 2)), color=colour, label=label)
    else:
        ax.plot(curve.x, curve.y, **LINES.get(curve.style, LINES["fit"]).drawn(), label=label)
