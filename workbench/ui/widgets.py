"""Widgets of Panel in the style of this page, and text that is safe to show."""

from __future__ import annotations

import html
from functools import cache
from importlib import resources
from typing import Any

import panel as pn

from workbench.core.palette import LINES
from workbench.report.numbers import plain, unbroken
from workbench.report.response import words_of


@cache
def style_sheet(name: str) -> str:
    """Return a style sheet of this package."""
    return resources.files("workbench.ui").joinpath("templates", name).read_text(encoding="utf-8")


def widget(kind: Any, **options: Any) -> Any:
    """Return a widget in the style of the page, as wide as its place."""
    options.setdefault("sizing_mode", None if "width" in options else "stretch_width")
    options.setdefault("margin", (2, 0))
    return kind(stylesheets=[style_sheet("widgets.css")], **options)


def button(name: str, act: Any, *, kind: str = "default", **options: Any) -> Any:
    """Return a button that calls `act()`."""
    out = widget(pn.widgets.Button, name=name, button_type=kind, **options)
    out.on_click(lambda event: act())
    return out


def text(content: str = "", **options: Any) -> Any:
    """Return a piece of HTML; names from elsewhere must already be escaped."""
    options.setdefault("margin", 0)
    return pn.pane.HTML(
        content, sizing_mode="stretch_width", stylesheets=[style_sheet("text.css")], **options
    )


def column(*objects: Any, **options: Any) -> Any:
    """Return objects below each other."""
    options.setdefault("margin", 0)
    return pn.Column(*objects, sizing_mode="stretch_width", **options)


def row(*objects: Any, **options: Any) -> Any:
    """Return objects beside each other, as long as there is room."""
    return pn.FlexBox(*objects, sizing_mode="stretch_width", gap="2px 16px", margin=0, **options)


def plot_pane(figure: Any) -> Any:
    """Return a figure for the page."""
    return pn.pane.Bokeh(figure, sizing_mode="stretch_width", margin=0)


def fade(pane: Any, old: bool) -> None:
    """Make a pane grey while its content is out of date; otherwise normal."""
    wanted = {"opacity": "0.45" if old else "1"}  # said both times: a browser keeps what is only left out
    if pane.styles != wanted:
        pane.styles = wanted


def safe(content: object) -> str:
    """Return any string as HTML."""
    return unbroken(html.escape(plain(content)))


_WORDS = {"before": "model as given", "after": "with the changes"}


def key(names: list[str]) -> str:
    """Return the legend of a diagram as HTML: measured points, and lines."""
    parts = []
    for name in names:
        look = LINES[name]
        dash = " ".join(f"{1.25 * d:g}" for d in look.dash) or "none"
        style = f"stroke: var(--{look.colour}); stroke-dasharray: {dash}; stroke-width: {1.25 * look.width:g}"
        mark = f'<path d="M0 4H28" style="{style}"/>'
        if name == "measured":
            mark = "".join(
                f'<circle cx="{x}" cy="4" r="2.5" style="fill: var(--{look.colour})"/>' for x in (8, 20)
            )
        line = f'<svg width="28" height="8" aria-hidden="true">{mark}</svg>'
        parts.append(f"<span>{line}{_WORDS.get(name) or words_of(name)}</span>")
    return f"<p class=key>{''.join(parts)}</p>"
