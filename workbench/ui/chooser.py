"""Selection of model and recordings."""

from __future__ import annotations

from typing import Any

import panel as pn

from .live import Live
from .widgets import button, column, safe, text, widget

_NONE = "none"
_OPEN = 10  # recordings; a longer list is folded away


class Chooser:
    """The model, the recordings, and the recording that is held out for testing."""

    def __init__(self, live: Live) -> None:
        self.live = live
        shelf = live.bench.shelf
        self.model = widget(pn.widgets.Select, name="Model", options=list(shelf.models))
        self.recordings = widget(pn.widgets.CheckBoxGroup, options=list(shelf.recordings))
        self.held_out = widget(pn.widgets.Select, name="Held out, to test", options=[_NONE])
        hint = "" if shelf.recordings else _no_recordings()
        if shelf.unreadable:
            names = "; ".join(f"{safe(n)} ({safe(why)})" for n, why in list(shelf.unreadable.items())[:3])
            more = f"; and {len(shelf.unreadable) - 3} more" if len(shelf.unreadable) > 3 else ""
            hint += f"<p class=quiet>Not offered: {names}{more}</p>"
        many = len(shelf.recordings) > _OPEN
        limits = {"scroll": True, "max_height": 230} if many else {}
        self.boxes = column(self.recordings, visible=not many, **limits)
        self.fold = button("", self._fold, visible=many)
        self._name_fold()
        parts: list[Any] = [
            self.model,
            text("<p class=label>Recordings</p>"),
            self.fold,
            self.boxes,
            text(hint),
            self.held_out,
        ]
        self.view = column(*parts)
        self._following = False
        for part in (self.model, self.recordings, self.held_out):
            part.param.watch(lambda event: self._chosen(), "value")

    def follow(self) -> None:
        """Show the present selection."""
        chosen = self.live.bench.chosen
        if chosen is None:
            return
        self._following = True
        try:
            self.model.value = chosen.model_label
            self.recordings.value = list(chosen.labels)
            self.held_out.options = [_NONE, *(chosen.labels if len(chosen.labels) > 1 else ())]
            self.held_out.value = chosen.held_out or _NONE
        finally:
            self._following = False
        self._name_fold()

    def _fold(self) -> None:
        """Show or hide the list of recordings."""
        self.boxes.visible = not self.boxes.visible
        self._name_fold()

    def _name_fold(self) -> None:
        """How many are chosen, beside what the button does."""
        act = "Hide" if self.boxes.visible else "Show"
        chosen, all_ = len(self.recordings.value), len(self.recordings.options)
        self.fold.name = f"{act} the recordings ({chosen} of {all_} chosen)"

    def _chosen(self) -> None:
        if self._following:
            return
        names = tuple(n for n in self.recordings.options if n in self.recordings.value)
        if not names:
            self.live.say("Choose at least one recording.")
            return
        held_out = None if self.held_out.value == _NONE else self.held_out.value
        self.live.choose(self.model.value, names, held_out)


def _no_recordings() -> str:
    return (
        "<p class=quiet>No recording was named, and none is in this folder. Make some with the virtual "
        "leg: <code>workbench record leg -o data</code></p>"
    )
