"""Buttons that write the model as a file and the report as a page into the working directory."""

from __future__ import annotations

from collections.abc import Callable

import panel as pn

from workbench.core import Comparison, Diagnosis, WorkbenchError

from .live import Live
from .widgets import button, column, widget


class Saving:
    """Names of the files, and the buttons that write them."""

    def __init__(self, live: Live) -> None:
        self.live = live
        self.model = widget(pn.widgets.TextInput, name="Model file", value="better.toml")
        self.report = widget(pn.widgets.TextInput, name="Report page", value="report.html")
        self.over = widget(pn.widgets.Checkbox, name="Overwrite files that exist")
        self.view = column(
            self.model,
            button("Save the model", self._save_model),
            self.report,
            button("Save the report", self._save_report),
            self.over,
        )
        self._waits = False  # the report is asked for, and its comparison is still being made

    def follow(self) -> None:
        """Save a requested report as soon as it can be made; not after an error."""
        if not self._waits:
            return
        if self.live.message[1] or self.live.bench.history is None:
            self._waits = False
        elif self._result() is not None:
            self._save_report()

    def _save_model(self) -> None:
        bench = self.live.bench
        self._say(lambda: f"Saved the model as {bench.save_model(self.model.value, force=self.over.value)}.")

    def _result(self) -> Comparison | Diagnosis | None:
        """What tells of the model as it is: a diagnosis that was made of it, or else the comparison."""
        bench, now = self.live.bench, self.live.now
        told = None if bench.history is None else bench.told()
        return told or (now.comparison if now else None)

    def _save_report(self) -> None:
        result = self._result()
        self._waits = result is None and self.live.bench.history is not None
        if self._waits:
            self.live.say("The report is saved once the comparison is done.")
            return

        def save() -> str:
            assert result is not None
            path = self.live.bench.save_report(self.report.value, result, force=self.over.value)
            return f"Saved the page of the {type(result).__name__.lower()} as {path}."

        self._say(save)

    def _say(self, save: Callable[[], str]) -> None:
        try:
            if self.live.bench.history is None:
                self.live.say("No model is chosen.", wrong=True)
                return
            self.live.say(save())
        except WorkbenchError as error:
            remedy = str(error).replace("add --force", "tick 'Overwrite files that exist'")
            self.live.say(remedy, wrong=True)
