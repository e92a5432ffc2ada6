"""Layout of a sheet as one HTML page."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.files import check_free, write_whole

from .numbers import plain, rounded
from .sheet import STYLES, Curve, Drawing, Panel, Row, Section, Sheet, table_parts
from .shell import compress, plotly, reproduce, template

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Most points of a curve; a longer one is thinned evenly along a logarithmic axis.
_POINTS = 500


def write_sheet(
    sheet: Sheet,
    path: str | Path,
    *,
    command: str,
    seeds: Mapping[str, int] | None = None,
    inputs: Sequence[str | Path] = (),
    force: bool = False,
) -> Path:
    """Write a sheet as one HTML page, complete or not at all; arguments and errors as `write_page`."""
    check_free(path, force=force)
    page = render_sheet(sheet, command=command, seeds=seeds, inputs=inputs)
    return write_whole(path, page, force=force)


def render_sheet(
    sheet: Sheet, *, command: str, seeds: Mapping[str, int] | None = None, inputs: Sequence[str | Path] = ()
) -> str:
    """Return the page as HTML text; see `write_sheet`."""
    drawings = [d for s in sheet.sections for d in s.drawings]
    panels = [p for d in drawings for p in d.panels]
    numbered = iter(range(len(panels)))
    return template("sheet.html.j2").render(
        kind=plain(sheet.kind),
        model=plain(sheet.model),
        tone=sheet.tone,
        sentence=plain(sheet.sentence),
        lines=[plain(line) for line in sheet.lines],
        key_numbers=[tuple(map(plain, entry)) for entry in sheet.key_numbers],
        sections=[_section(s, numbered) for s in sheet.sections],
        reproduce=reproduce(command, seeds, inputs),
        fallback=_picture(drawings[0]) if panels else None,
        values=compress(json.dumps([_panel(p) for p in panels]).encode()) if panels else "",
        plotly=plotly() if panels else "",
    )


def _section(section: Section, numbered: Iterator[int]) -> dict[str, Any]:
    return {
        "id": section.id,
        "title": plain(section.title),
        "sentences": [plain(s) for s in section.sentences],
        "tables": [table_parts(t) for t in section.tables],
        "drawings": [
            {
                "caption": plain(d.caption),
                "key": _key(d),
                "panels": [
                    {"id": f"plot-{next(numbered)}", "title": plain(p.title), "wide": p.wide}
                    for p in d.panels
                ],
            }
            for d in section.drawings
        ],
        "remarks": [plain(r) for r in section.remarks],
        "picture": _inline(section.picture),
    }


def _picture(drawing: Drawing) -> dict[str, str]:
    """A drawing as a picture, with what it shows in words."""
    from .sheet_picture import panels_figure  # slow to import, and only pages that draw need it
    from .style import embedded

    words = " ".join(panel.summary for panel in drawing.panels)
    return {"picture": embedded(panels_figure(drawing.panels), dpi=110), "words": plain(words)}


def _inline(picture: tuple[Figure, str] | None) -> dict[str, Any] | None:
    """A figure as part of the page, with what it shows in words."""
    if picture is None:
        return None
    from .style import inline  # slow to import, and only pictures need it

    return {"svg": inline(picture[0]), "words": plain(picture[1])}


def _key(drawing: Drawing) -> list[dict[str, Any]]:
    """Every curve's name once, with its look."""
    seen = {c.name: c.style for p in drawing.panels for r in p.rows for c in r.curves}
    out = []
    for name, style in seen.items():
        colour, dash, width = STYLES.get(style, STYLES["fit"])
        dots = dash.replace("px", "").replace(",", " ") if dash[0].isdigit() else ""
        shape = dash if dash in ("dot", "band") else "line"
        out.append({"name": plain(name), "colour": colour, "dash": dots, "width": width, "shape": shape})
    return out


def _panel(panel: Panel) -> dict[str, Any]:
    return {
        "x": plain(panel.x_label),
        "log": panel.log,
        "summary": plain(panel.summary),
        "rows": [
            {
                "y": plain(r.label),
                "log": r.log,
                "range": _range(r),
                "curves": [_curve(c, panel.log) for c in r.curves],
            }
            for r in panel.rows
        ],
    }


def _range(row: Row) -> list[float] | None:
    """Powers of ten that hold all curves of a logarithmic diagram: a band that reaches to zero is cut."""
    if not row.log:
        return None
    shown = [c.high if c.y is None else c.y for c in row.curves]
    values = np.concatenate([np.asarray(v, float) for v in shown if v is not None])
    logs = np.log10(values[np.isfinite(values) & (values > 0)])
    if not len(logs):
        return None
    air = 0.05 * max(float(np.ptp(logs)), 0.3)
    return [float(logs.min()) - air, float(logs.max()) + air]


def _curve(curve: Curve, log: bool) -> dict[str, Any]:
    colour, dash, width = STYLES.get(curve.style, STYLES["fit"])
    keep = _kept(curve.x, log)
    values = {"x": curve.x, "v": curve.y, "low": curve.low, "high": curve.high}
    numbers = {k: rounded(np.asarray(v)[keep], 5) for k, v in values.items() if v is not None}
    return {"name": plain(curve.name), "colour": colour, "dash": dash, "width": width, **numbers}


def _kept(x: np.ndarray, log: bool) -> np.ndarray:
    """Which points are drawn."""
    if len(x) <= _POINTS:
        return np.arange(len(x))
    ends = (max(float(x[0]), 1e-9), float(x[-1]))
    wanted = np.geomspace(*ends, _POINTS) if log else np.linspace(x[0], x[-1], _POINTS)
    return np.unique(np.clip(np.searchsorted(x, wanted), 0, len(x) - 1))
