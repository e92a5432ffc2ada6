"""One page: all views of the bench, updated after every change."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn
from bokeh.events import RangesUpdate, Tap
from bokeh.models import ColumnDataSource

from workbench.effects import axis_units
from workbench.report.numbers import plain
from workbench.report.pack import worst_view
from workbench.report.residuals import worst_window

from .changes import Changes
from .chooser import Chooser
from .curves import Curves
from .finding import Findings
from .live import Live
from .motion import moving_picture
from .residual_map import MapView, residual_map
from .response_part import ResponsePart
from .runs import Runs
from .saving import Saving
from .summary import NOTHING_CHOSEN, numbers, verdict, where_words
from .widgets import column, fade, plot_pane, row, safe, text, widget

_WHOLE_S, _STRETCH_S = 20.0, 3.0  # a longer recording opens where it fails most, for so long
_FIXED: dict[str, Any] = {"width": 180}


class Page:
    """Content of one browser tab."""

    def __init__(self, live: Live, document: Any) -> None:
        self.live, self.document = live, document
        self.chooser, self.findings = Chooser(live), Findings(live)
        self.changes, self.saving = Changes(live), Saving(live)
        self.curves, self.map, self.responses = Curves(), MapView(), ResponsePart(live, document)
        self.summary, self.numbers, self.message, self.where = text(), text(), text(), text()
        self.recording = widget(pn.widgets.Select, name="Recording", options={}, **_FIXED)
        self.axis = widget(pn.widgets.Select, name="Axis", options={}, **_FIXED)
        self.against = widget(
            pn.widgets.Select, name="Against", options=["time", "speed", "position"], **_FIXED
        )
        self.motion = ColumnDataSource({"t": []}, name="motion")
        self.curves.figures[0].tags = [self.motion]
        self._inputs: object = None
        self._placed = False  # whether the page has chosen what to look at first
        self._asked: set[str] = set()
        self.curve_panes = [plot_pane(f) for f in self.curves.figures]
        self.map_pane = plot_pane(self.map.plot)
        #: Name in the template to what stands there.
        self.roots: dict[str, Any] = {
            "summary": self.summary,
            "numbers": self.numbers,
            "message": self.message,
            "chooser": self.chooser.view,
            "findings": self.findings.view,
            "changes": self.changes.view,
            "more": self.changes.more,
            "saving": self.saving.view,
            "look": row(self.recording, self.axis),
            "curves": column(*self.curve_panes),
            "against": self.against,
            "map": self.map_pane,
            "where": self.where,
            "frf": self.responses.view,
        }
        self._watch()
        self._end = live.listen(self._later)
        self._later("inputs")

    def close(self) -> None:
        """Release everything after the tab was closed."""
        self._end()

    def _watch(self) -> None:
        self.recording.param.watch(lambda event: self._look(), "value")
        self.axis.param.watch(lambda event: self._draw(), "value")
        self.against.param.watch(lambda event: self._draw_map(), "value")
        self.curves.figures[0].on_event(RangesUpdate, lambda event: self._draw_curves())
        self.map.plot.on_event(Tap, self._tapped)

    def _later(self, what: str) -> None:
        """Draw once this tab's document may be changed; several reasons at once make one drawing."""
        if not self._asked:
            self.document.add_next_tick_callback(self._follow)
        self._asked.add(what)

    def _follow(self) -> None:
        asked, self._asked = self._asked, set()
        if "inputs" in asked:
            self.chooser.follow()
            self._inputs_changed()
        if asked & {"inputs", "model", "work"}:
            self.changes.follow()
        if asked & {"inputs", "model", "work", "diagnosis"}:
            self.findings.follow()
        self.saving.follow()
        if asked & {"inputs", "message"}:
            words, wrong = self.live.message
            role, kind = ("alert", "wrong") if wrong else ("status", "fine")
            self.message.object = f"<p role='{role}' class='{kind}'>{safe(words)}</p>"
            self.message.visible = bool(words)
        if asked & {"inputs", "model", "runs", "comparison"}:
            self._summarise()
        if asked & {"inputs", "comparison"}:
            self._place()
        if asked & {"inputs", "runs", "comparison"}:
            self._draw()
        self._fade()

    def _fade(self) -> None:
        """Grey what is of another model, or of other recordings, than those on the bench."""
        now, loading = self.live.now, self.live.loading
        fade(self.where, loading or now is None or now.comparison is None)
        for pane in (self.map_pane, *self.curve_panes):
            fade(pane, loading or (pane is self.map_pane and (now is None or now.entries is None)))
        fade(self.summary, loading)

    def tick(self) -> None:
        """Update the times that are shown during a computation."""
        if self.live.work is not None:
            self.findings.tick()

    def _inputs_changed(self) -> None:
        chosen = self.live.bench.chosen
        if chosen is None or chosen is self._inputs:
            return
        self._inputs, self._placed = chosen, False
        names = {plain(r.name): i for i, r in enumerate(chosen.recordings)}
        self.recording.options = names
        self.recording.value = min(self.live.focus, len(names) - 1)
        self.axis.options = {plain(a): k for k, a in enumerate(chosen.model.axes)}
        if self.axis.value is None or self.axis.value >= len(chosen.model.axes):
            self.axis.value = 0
        self.responses.forget()
        self._look()

    def _place(self) -> None:
        """Look first where the model fails most."""
        chosen, given = self.live.bench.chosen, self.live.given
        if self._placed or chosen is None or given is None or given.comparison is None:
            return
        self._placed = True
        index, axis = worst_view(given.comparison)
        self.recording.value, self.axis.value = index, chosen.model.axes.index(axis)
        duration = chosen.recordings[index].duration
        if duration > _WHOLE_S:  # what is in sight follows a slider at once
            low, high = worst_window(given.comparison.recordings[index], axis)
            end = min(high, low + _STRETCH_S, duration)
            self.curves.time.update(start=max(0.0, min(low, end - 0.1)), end=end)
            self._draw_curves()

    @property
    def _index(self) -> int:
        chosen = self.live.bench.chosen
        last = len(chosen.recordings) - 1 if chosen else 0
        return min(self.recording.value or 0, last)

    def _look(self) -> None:
        """Another recording: all of its time, until the run says where to look."""
        chosen = self.live.bench.chosen
        if chosen is None:
            return
        self.live.look_at(self._index)
        recording = chosen.recordings[self._index]
        bounds = (0.0, recording.duration)
        self.curves.time.update(start=0.0, end=recording.duration, bounds=bounds, reset_start=0.0)
        self._draw()

    def _draw(self) -> None:
        self._draw_curves()
        now = self.live.now
        if now is not None and now.entries is not None:  # not while a slider moves
            self._draw_map()
            self._draw_motion()

    def _runs(self) -> tuple[Runs | None, Runs | None]:
        """The model's as given, and with changes; None where there is none."""
        given, now = self.live.given, self.live.now
        return given, None if now is given else now

    def _draw_curves(self) -> None:
        chosen = self.live.bench.chosen
        if chosen is None or self.axis.value is None:
            return
        self.live.window = (float(self.curves.time.start), float(self.curves.time.end))
        given, now = self._runs()
        comparison = next((r.comparison for r in (now, given) if r and r.comparison), None)
        self.curves.show(
            chosen.recordings[self._index],
            self.axis.value,
            given.shown.get(self._index) if given else None,
            (now.shown.get(self._index) or now.seen.get(self._index)) if now else None,
            comparison.recordings[self._index] if comparison else None,
        )

    def _draw_motion(self) -> None:
        chosen = self.live.bench.chosen
        if chosen is None:
            return
        given, now = self._runs()
        runs = {
            "before": given.shown.get(self._index) if given else None,
            "after": now.shown.get(self._index) if now else None,
        }
        self.motion.data = moving_picture(chosen.model, chosen.recordings[self._index], runs)

    def _draw_map(self) -> None:
        chosen, now = self.live.bench.chosen, self.live.now
        if chosen is None or now is None or now.entries is None:
            return
        against = self.against.value
        found = residual_map(now.entries, chosen.model.axes, against, self._index)
        units = dict(zip(chosen.model.axes, axis_units(chosen.model), strict=True))
        names = {"time": lambda u: "s", "speed": lambda u: f"{u}/s", "position": lambda u: u}
        self.map.show(found, against, [names[against](units[a]) for a, _ in found.rows])
        if now.comparison is not None:
            self.where.object = where_words(now.comparison)

    def _tapped(self, event: Any) -> None:
        """A cell of the map: look at its axis, and at its time."""
        found, chosen = self.map.found, self.live.bench.chosen
        if found is None or chosen is None or not found.rows or event.y is None:
            return
        place = len(found.rows) - 1 - int(np.clip(event.y, 0, len(found.rows) - 1))
        axis = found.rows[place][0]
        self.axis.value = chosen.model.axes.index(axis)
        if self.against.value == "time":
            end = chosen.recordings[self._index].duration
            half = max(0.03 * end, 0.1)
            low = float(np.clip(event.x - half, 0.0, max(end - 2 * half, 0.0)))
            self.curves.time.update(start=low, end=min(low + 2 * half, end))

    def _summarise(self) -> None:
        chosen, given, now = self.live.bench.chosen, self.live.given, self.live.now
        if chosen is None:
            self.summary.object = NOTHING_CHOSEN
            return
        comparison = now.comparison if now else None
        floor = next((r.comparison.noise_error for r in (now, given) if r and r.comparison), None)
        error = now.error if now else None
        self.summary.object = verdict(chosen.model.name, comparison)
        before = given.error if given and given is not now else None
        self.numbers.object = numbers(error, before, floor)
