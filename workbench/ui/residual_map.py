"""Where the model fails: each axis's and signal's residual over time, speed or position, by the noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from bokeh.models import ColumnDataSource, FactorRange, HoverTool, LinearColorMapper, Range1d

from workbench.core import RecordingError
from workbench.report.numbers import plain, short
from workbench.report.residuals import SIGNALS, column, has, noise, speed

from .plots import figure, set_height, set_range

_BINS = 24
_FEWEST = 12
_COLUMNS = ("x", "row", "ratio", "text", "range", "width")
#: Ratio of what is left to the noise at which the colour is full.
FULL = 100.0


@dataclass(frozen=True)
class ResidualMap:
    """A table of the residual divided by the noise.

    Attributes:
        rows: axis and signal, (R,).
        edges: of the bins, (R, B + 1): an axis has its own.
        ratio: root mean square of what is left over the noise, (R, B); NaN where too few samples lie.
    """

    rows: tuple[tuple[str, str], ...]
    edges: np.ndarray
    ratio: np.ndarray


def residual_map(
    entries: Sequence[RecordingError], axes: Sequence[str], against: str, shown: int
) -> ResidualMap:
    """Return the table over ``time`` (of recording `shown`), ``speed`` or ``position`` (of all)."""
    chosen = [entries[shown]] if against == "time" else list(entries)
    rows, edges, ratios = [], [], []
    for axis in axes:
        for name, label in SIGNALS:
            parts = [_part(e, axis, name, against) for e in chosen]
            parts = [p for p in parts if p is not None]
            if not parts:
                continue
            x = np.concatenate([p[0] for p in parts])
            y = np.concatenate([p[1] for p in parts])
            low, high = np.quantile(x, [0.002, 0.998]) if len(x) else (0.0, 1.0)
            own = np.linspace(low, high if high > low else low + 1.0, _BINS + 1)
            which = np.clip(np.digitize(x, own) - 1, 0, _BINS - 1)
            count = np.bincount(which, minlength=_BINS)
            square = np.bincount(which, y**2, minlength=_BINS)
            rows.append((axis, label))
            edges.append(own)
            ratios.append(np.where(count >= _FEWEST, np.sqrt(square / np.maximum(count, 1)), np.nan))
    return ResidualMap(
        tuple(rows), np.array(edges).reshape(-1, _BINS + 1), np.array(ratios).reshape(-1, _BINS)
    )


def _part(entry: RecordingError, axis: str, name: str, against: str) -> tuple[np.ndarray, np.ndarray] | None:
    k = column(entry, axis)
    if k is None or not has(entry, name):
        return None
    floor = noise(entry, name, k)
    if not (np.isfinite(floor) and floor > 0):
        return None
    r = entry.recording
    x = {"time": lambda: r.time, "speed": lambda: speed(entry)[:, k], "position": lambda: r.position[:, k]}
    left = entry.residual(name)[:, k] / floor  # pyright: ignore[reportArgumentType]
    values = x[against]()
    good = np.asarray(r.valid, bool) & np.isfinite(left) & np.isfinite(values)
    return values[good], left[good]


class MapView:
    """The table as a picture: one row per axis and signal, darker for larger residuals."""

    def __init__(self) -> None:
        self.source = ColumnDataSource({k: [] for k in _COLUMNS})
        self.plot = figure(height=200, y_range=FactorRange(), x_range=Range1d(start=0, end=1))
        #: colours are set in the browser, by its scheme
        self.mapper = LinearColorMapper(low=0.0, high=1.0, palette=["#ffffff", "#d55e00"], name="map colours")
        self.cells = self.plot.rect(
            "x",
            "row",
            "width",
            0.92,
            source=self.source,
            line_color=None,
            fill_color={"field": "ratio", "transform": self.mapper},
            nonselection_fill_alpha=1.0,
        )
        tips = [("", "@row"), ("at", "@range"), ("error over noise", "@text")]
        self.plot.add_tools(HoverTool(renderers=[self.cells], tooltips=tips))
        self.plot.grid.visible = False
        self.plot.xaxis.ticker.desired_num_ticks = 6
        self.found: ResidualMap | None = None

    def show(self, found: ResidualMap, against: str, units: Sequence[str]) -> None:
        """Draw a table; `units`: of the quantity, one per row."""
        self.found = found
        names = [f"{plain(a)} {s}" for a, s in found.rows]
        same = against == "time" or (len(set(units)) == 1 and len(found.rows) > 0)
        wide = len(found.rows) > 0
        low = float(found.edges[:, 0].min()) if wide else 0.0
        high = float(found.edges[:, -1].max()) if wide else 1.0
        out: dict[str, list[object]] = {k: [] for k in _COLUMNS}
        for name, edges, ratios, unit in zip(names, found.edges, found.ratio, units, strict=True):
            for a, b, ratio in zip(edges[:-1], edges[1:], ratios, strict=True):
                if np.isfinite(ratio):
                    out["x"].append(0.5 * (a + b))
                    out["width"].append((b - a) * 1.01)
                    out["row"].append(name)
                    # logarithmic, from the noise on
                    out["ratio"].append(float(np.clip(np.log(max(ratio, 1.0)) / np.log(FULL), 0, 1)))
                    out["text"].append(f"{ratio:.3g}")
                    out["range"].append(f"{short(float(a))} to {short(float(b))} {unit}")
        self.plot.y_range.factors = names[::-1]
        set_height(self.plot, 64 + 26 * max(2, len(names)))
        self.plot.xaxis.axis_label = f"{against} [{units[0]}]" if same and units else against
        set_range(self.plot.x_range, low, high)
        self.source.data = out
