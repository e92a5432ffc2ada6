"""Measured and simulated signals against time, and the residual, with one zoom for all diagrams."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, Range1d

from workbench.core import Recording, RecordingError
from workbench.core.units import torque_unit
from workbench.report.numbers import handy
from workbench.report.residuals import min_max

from .plots import band, crosshair, figure, line, set_height, set_range, span_of, zooming

_BINS = 900  # stretches that a curve is thinned to: about one per pixel
_SIGNALS = (("position", "position"), ("torque_measured", "torque"))
_LOOKS = ("measured", "before", "after")
_HEIGHTS, _BELOW = (190, 125), 46  # of a curve and of its residual, and what the time takes below [pixels]


class Curves:
    """Position, its residual, torque and its residual, for one axis of one recording.

    Attributes:
        figures: the four diagrams, top first.
        time: the stretch of time that all show [s].
    """

    def __init__(self) -> None:
        self.time: Any = Range1d(start=0, end=1)
        self.figures: list[Any] = []
        self._sources: list[ColumnDataSource] = []
        self._noise: list[ColumnDataSource] = []
        #: where the moving picture is, drawn by the page itself
        self.cursor = ColumnDataSource({"x": [float("nan")]}, name="cursor")
        for _ in _SIGNALS:
            for residual in (False, True):
                self._add(residual)
        crosshair(self.figures)
        self._number_time(self.figures[-1])

    def _add(self, residual: bool) -> None:
        plot = figure(height=_HEIGHTS[residual], x_range=self.time, y_range=Range1d(start=-1, end=1))
        source = ColumnDataSource({"t": [], **{look: [] for look in _LOOKS}})
        if residual:
            noise = ColumnDataSource({"t": [], "low": [], "high": []})
            band(plot, noise, "t", "low", "high", "noise", 0.28)
            self._noise.append(noise)
        for look in _LOOKS[1:] if residual else _LOOKS:
            line(plot, source, "t", look, look)
        plot.vspan(x="x", source=self.cursor, line_width=1.2, tags=["line:accent"])
        zooming(plot)
        # numbers of the same width keep diagrams above each other aligned
        plot.yaxis.ticker.desired_num_ticks = 4 if residual else 5
        plot.xaxis.major_label_text_font_size = "12px"
        plot.xaxis.axis_label = "time [s]"
        self.figures.append(plot)
        self._sources.append(source)

    def show(
        self,
        recording: Recording,
        axis: int,
        before: Recording | None,
        after: Recording | None,
        noise: RecordingError | None,
    ) -> None:
        """Draw the selected stretch of time.

        Args:
            recording: measured.
            axis: its column.
            before, after: runs of the model as given, and with the changes; None where there is none.
            noise: where the noise is known.
        """
        unit, lowest = recording.units[axis], self.figures[0]
        for k, (name, label) in enumerate(_SIGNALS):
            top, bottom = self.figures[2 * k], self.figures[2 * k + 1]
            measured = recording.get(name)
            if measured is None and name == "torque_measured":
                name, measured = "torque_command", recording.get("torque_command")
            top.visible = bottom.visible = measured is not None
            if measured is None:
                continue
            its = unit if label == "position" else torque_unit(unit)
            runs = {
                look: run.signals[name][:, axis]
                for look, run in (("before", before), ("after", after))
                if run is not None and run.get(name) is not None
            }
            if (
                k and not self.figures[1].visible
            ):  # along the measured motion; rows that do not count are no run
                runs = {look: np.where(run == measured[:, axis], np.nan, run) for look, run in runs.items()}
            real = np.where(recording.valid, measured[:, axis], np.nan)
            curves = {"measured": real, **runs}
            followed = runs and all(np.array_equal(run, measured[:, axis]) for run in runs.values())
            self._fill(2 * k, recording, curves, f"{label}{', given' if followed else ''} [{its}]", 1.0)
            lowest = top
            if followed:  # where the loop is unknown the motion is the measured one, and says nothing
                bottom.visible = False
                continue
            left = {look: real - run for look, run in runs.items()}
            sizes = [float(np.nanstd(x)) for x in left.values()] or [0.0]
            factor, small = handy([3 * max(sizes)], its)
            levels = () if noise is None else (noise.position_noise, noise.torque_noise)
            floor = float(levels[k][axis]) if levels else float("nan")
            self._fill(2 * k + 1, recording, left, f"residual [{small}]", factor, floor)
            lowest = bottom
        self._number_time(lowest)

    def _number_time(self, lowest: Any) -> None:
        """Write the time below the lowest diagram only."""
        for k, plot in enumerate(self.figures):
            plot.xaxis.visible = plot is lowest
            set_height(plot, _HEIGHTS[k % 2] + (_BELOW if plot is lowest else 0))

    def _fill(
        self,
        at: int,
        recording: Recording,
        curves: dict[str, np.ndarray],
        label: str,
        factor: float,
        noise: float = float("nan"),
    ) -> None:
        plot, dt, count = self.figures[at], recording.period, len(recording)
        first = int(np.clip(np.floor(self.time.start / dt) - 1, 0, count - 1))
        last = int(np.clip(np.ceil(self.time.end / dt) + 2, first + 2, count))
        thin = {look: thinned(factor * values[first:last], dt, first) for look, values in curves.items()}
        longest = max((t for t, _ in thin.values()), key=len, default=np.zeros(0))
        empty = np.full(len(longest), np.nan)
        columns = {look: thin[look][1] if look in thin else empty for look in _LOOKS}
        shown = [v for v in columns.values() if np.isfinite(v).any()]
        low, high = min(map(np.nanmin, shown), default=-1.0), max(map(np.nanmax, shown), default=1.0)
        if at % 2:
            floor = 2 * factor * noise
            edge = [floor, floor] if np.isfinite(floor) else []
            self._noise[at // 2].data = {
                "t": [0.0, recording.duration][: len(edge)],
                "low": [-e for e in edge],
                "high": edge,
            }
            low, high = (min(low, -floor), max(high, floor)) if edge else (low, high)
        self._sources[at].data = {"t": longest, **columns}
        plot.yaxis.axis_label = label
        set_range(plot.y_range, *span_of(float(low), float(high)))


def thinned(values: np.ndarray, dt: float, first: int) -> tuple[np.ndarray, np.ndarray]:
    """Return times and values for display: least and greatest of each stretch, with gaps.

    Args:
        values: (N,), NaN in gaps.
        dt: of a row [s].
        first: number of the first row.
    """
    gaps = ~np.isfinite(values)
    filled = np.where(gaps, np.nanmean(values) if not gaps.all() else 0.0, values)
    thin, stride = min_max(filled, _BINS)
    rows = stride * np.arange(len(thin))
    at = np.clip(rows.astype(int), 0, len(values) - 1)
    return dt * (first + rows), np.where(gaps[at], np.nan, thin)
