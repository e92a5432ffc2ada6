"""Drawings of the unexplained torque: a fitted smooth function, and the data to which it was fitted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core import Diagnosis, Shape
from workbench.core.palette import COLOURS, LINES

from .numbers import number, percent, plain, rounded, short

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MOST = 4


def shape_figure(result: Diagnosis) -> Figure:
    """Return a figure: smooth functions that the missing torque follows, with twice their deviation.

    Args:
        result: a diagnosis that has some.
    """
    from workbench.core.picture import Picture  # slow to load, and most results are drawn elsewhere

    from .style import house_style

    shown = result.shapes[:_MOST]
    with house_style():
        figure = Picture(
            figsize=(3.6 * min(len(shown), 2), 2.9 * ((len(shown) + 1) // 2)), layout="constrained"
        )
        grid = figure.subplots((len(shown) + 1) // 2, min(len(shown), 2), squeeze=False)
        for a, shape in zip(grid.flat, shown, strict=False):
            a.fill_between(
                shape.grid,
                shape.torque - 2.0 * shape.std,
                shape.torque + 2.0 * shape.std,
                color=COLOURS["before"][0],
                alpha=0.2,
                linewidth=0.0,
            )
            a.plot(shape.grid, shape.seen, "o", ms=3, color=COLOURS["measured"][0])
            a.plot(shape.grid, shape.torque, **LINES["before"].drawn())
            a.set_xlabel(_along(shape))
            a.set_ylabel(f"missing torque at {plain(shape.axis)} [{shape.torque_unit}]")
            a.set_title(f"{_titled(shape)}: {percent(shape.share)}")
        for a in grid.flat[len(shown) :]:
            a.set_visible(False)
        figure.suptitle("What no effect explains: descriptions, not causes", fontsize=10)
    return figure


def shape_rows(shapes: Sequence[Shape]) -> list[dict[str, Any]]:
    """Return what the page draws and states of each, the one that removes most first, as text and numbers."""
    rows = []
    for shape in shapes[:_MOST]:
        along, *others = (plain(q) for q in shape.quantities)
        held = f", {others[0]} at its median" if others else ""
        curve = {key: rounded(getattr(shape, key)) for key in ("grid", "torque", "seen")}
        edges = {
            "low": rounded(shape.torque - 2.0 * shape.std),
            "high": rounded(shape.torque + 2.0 * shape.std),
        }
        rows.append(
            {
                "title": f"{plain(shape.axis)}: {_titled(shape)}",
                "share": percent(shape.share),
                "remark": held.removeprefix(", "),
                "x": f"{along} [{shape.units[0]}]",
                "y": f"missing torque [{shape.torque_unit}]",
                "unit": shape.torque_unit,
                "about": f"Missing torque at {plain(shape.axis)} against {along}{held}: {_ends(shape)}.",
                **curve,
                **edges,
            }
        )
    return rows


def _ends(shape: Shape) -> str:
    """Where a function is least and most, in words."""
    unit, at = shape.torque_unit, (int(np.argmin(shape.torque)), int(np.argmax(shape.torque)))
    ends = [
        f"{word} {number(float(shape.torque[k]))} {unit} at {short(float(shape.grid[k]))} {shape.units[0]}"
        for word, k in zip(("least", "most"), at, strict=True)
    ]
    return f"{', '.join(ends)}, each ± {number(2.0 * float(np.median(shape.std)), 2)} {unit}"


def _titled(shape: Shape) -> str:
    if shape.frequency is not None:
        return f"a tone of {shape.frequency:.3g} Hz"
    return " and ".join(plain(q) for q in shape.quantities)


def _along(shape: Shape) -> str:
    first, *others = (plain(q) for q in shape.quantities)
    rest = f", {others[0]} at its median" if others else ""
    return f"{first} [{shape.units[0]}]{rest}"
