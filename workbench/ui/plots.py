"""Bokeh figures in the style of this page; the browser sets their colours."""

from __future__ import annotations

from typing import Any

from bokeh.models import BoxZoomTool, ColumnDataSource, CrosshairTool, Range1d, WheelZoomTool
from bokeh.plotting import figure as new_figure

from workbench.core.palette import LINES

_SMALL = "12px"
_FONT = "system-ui, Segoe UI, Roboto, Noto Sans, DejaVu Sans, sans-serif"
#: px; a browser follows a change of the least height of a figure that it drew, but not one of the height
_LEAST_HEIGHT = 40


def figure(*, height: int, x_label: str = "", y_label: str = "", **options: Any) -> Any:
    """Return an empty figure without a toolbar, as wide as its place."""
    out = new_figure(
        height=_LEAST_HEIGHT,
        min_height=height,
        sizing_mode="stretch_width",
        toolbar_location=None,
        tools="",
        min_border_left=64,
        min_border_right=8,
        min_border_top=6,
        min_border_bottom=4,
        outline_line_color=None,
        background_fill_color=None,
        border_fill_color=None,
        output_backend="canvas",
        **options,
    )
    for axis, label in ((out.xaxis, x_label), (out.yaxis, y_label)):
        axis.axis_label = label
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_font_size = axis.major_label_text_font_size = _SMALL
        axis.axis_label_text_font = axis.major_label_text_font = _FONT
        axis.minor_tick_line_color = None
        axis.major_tick_in, axis.major_tick_out = 0, 4
    return out


def set_height(plot: Any, height: int) -> None:
    """Set the height of a figure [px], which may be on a page already."""
    plot.min_height = height


def line(plot: Any, source: ColumnDataSource, x: str, y: str, look: str, **options: Any) -> Any:
    """Add a curve in the style of its name in `LINES`; slightly wider than on paper."""
    style = LINES[look]
    dash = [round(1.25 * d) for d in style.dash]
    return plot.line(
        x,
        y,
        source=source,
        line_width=min(1.25 * style.width, 3.0),
        line_dash=dash,
        line_color=style.light,
        tags=[f"line:{style.colour}"],
        **options,
    )


def band(plot: Any, source: ColumnDataSource, x: str, low: str, high: str, colour: str, alpha: float) -> Any:
    """Add a band between two curves."""
    return plot.varea(x, low, high, source=source, fill_alpha=alpha, tags=[f"fill:{colour}"])


def zooming(plot: Any) -> None:
    """Add zooming: drag over a stretch of time, or use the wheel with Ctrl."""
    box = BoxZoomTool(dimensions="width")
    wheel = WheelZoomTool(dimensions="width", modifiers={"ctrl": True})
    plot.add_tools(box, wheel)
    plot.toolbar.active_drag = box


def crosshair(plots: list[Any]) -> None:
    """Add one vertical line through all diagrams at the pointer."""
    from bokeh.models import Span

    span = Span(dimension="height", line_width=1, line_alpha=0.5, tags=["line:quiet"])
    for plot in plots:
        plot.add_tools(CrosshairTool(overlay=span, dimensions="height"))


def span_of(low: float, high: float) -> tuple[float, float]:
    """Return limits with margins for values from `low` to `high`."""
    air = 0.06 * (high - low) or 0.05 * abs(high) or 1.0
    return low - air, high + air


def set_range(current: Range1d, low: float, high: float) -> None:
    """Set a range in one step."""
    current.update(start=low, end=high)
