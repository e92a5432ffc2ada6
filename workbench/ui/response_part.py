"""Frequency responses on the page; estimated on request, because this takes some time."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn

from workbench.report.numbers import plain

from .live import Live
from .responses import Responses, ResponseView, responses
from .widgets import button, column, key, plot_pane, row, safe, text, widget


class ResponsePart:
    """A button, the selection of an entry, and its magnitude and phase."""

    def __init__(self, live: Live, document: Any) -> None:
        self.live, self.document = live, document
        self.plots = ResponseView()
        self.entry = widget(pn.widgets.Select, name="Response", options={}, width=180)
        self.variants = widget(pn.widgets.Checkbox, name="Closed chain and serial variants", width=240)
        self.told, self.key, self.notes = text(), text(), text()
        self.view = column(
            row(button("Estimate the responses", self._estimate, width=200), self.entry, self.variants),
            self.told,
            self.key,
            plot_pane(self.plots.magnitude),
            plot_pane(self.plots.phase),
            self.notes,
        )
        self._found: Responses | None = None
        for part in (self.entry, self.variants):
            part.param.watch(lambda event: self._draw(), "value")
        self.forget()

    def forget(self) -> None:
        """Remove the responses after other recordings were selected."""
        self._found = None
        self.told.object = self.key.object = self.notes.object = ""
        self.entry.visible = self.variants.visible = False
        self.plots.magnitude.visible = self.plots.phase.visible = False

    def _estimate(self) -> None:
        chosen = self.live.bench.chosen
        given, now = self.live.given, self.live.now
        if chosen is None or given is None or given.entries is None:
            self.told.object = "<p class=quiet>Choose recordings first.</p>"
            return
        runs = {"before": [e.simulated for e in given.entries]}
        if now is not None and now is not given and now.entries is not None:
            runs["after"] = [e.simulated for e in now.entries]
        self.told.object = "<p class=quiet>Estimating …</p>"

        def done(found: Responses) -> None:
            self.document.add_next_tick_callback(lambda: self._took(found))

        def failed(words: str) -> None:
            def show() -> None:
                self.told.object = f"<p class=quiet>These recordings give no response: {safe(words)}</p>"

            self.document.add_next_tick_callback(show)

        self.live.responses(lambda: responses(chosen.model, chosen.recordings, runs), done, failed)

    def _took(self, found: Responses) -> None:
        self._found = found
        frf = found.measured
        options = {
            f"{plain(frf.outputs[i].axis)} over {plain(frf.inputs[j].axis)}": (i, j)
            for i, j in np.ndindex(*frf.response.shape[1:])
        }
        self.entry.options = options
        self.entry.value = self.entry.value if self.entry.value in options.values() else (0, 0)
        several = set(found.models) - {"before", "after"}
        self.entry.visible, self.variants.visible = True, bool(several)
        self.plots.magnitude.visible = self.plots.phase.visible = True
        out = frf.outputs[0].signal.replace("_", " ")
        self.told.object = (
            f"<p class=quiet>From {safe(frf.inputs[0].signal.replace('_', ' '))} to {safe(out)}; runs of the "
            f"model go through the same estimate. Grey: 95 % of the measurement. {len(frf)} lines.</p>"
        )
        self.notes.object = "".join(f"<p class=quiet>{safe(note)}</p>" for note in frf.notes)
        self._draw()

    def _draw(self) -> None:
        if self._found is not None and self.entry.value is not None:
            i, j = self.entry.value
            drawn = self.plots.show(self._found, i, j, self.variants.value)
            self.key.object = key(["measured", *drawn])
