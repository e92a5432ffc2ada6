"""Effects in the model with one slider per parameter; undo and redo; adding by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn

from workbench.core import EffectKey
from workbench.effects import effect_named, places
from workbench.models import AppliedEffect
from workbench.report import wording as w
from workbench.report.numbers import unit_text

from .live import Live
from .widgets import button, column, row, safe, text, widget

_STEPS = 400
# cards stand beside each other, so that the curves stay in sight below their sliders
_CARD = {"width": "auto", "flex": "1 1 17rem", "max-width": "26rem"}
_TAKES_REST = {"width": "auto", "flex": "1 1 12rem"}  # less, and it takes a line of its own


class Changes:
    """The present model, and everything that can be changed in it.

    Attributes:
        view: undo, redo, and the effects with their sliders.
        more: any effect of the catalogue, to be added by hand.
    """

    def __init__(self, live: Live) -> None:
        self.live = live
        self.undo = button("Undo", lambda: self._step("undo"), sizing_mode=None)
        self.redo = button("Redo", lambda: self._step("redo"), sizing_mode=None)
        self.added, self.given = row(), row(visible=False)
        self.show_given = widget(pn.widgets.Checkbox, name="Show the effects of the model as given")
        self.show_given.param.watch(lambda event: setattr(self.given, "visible", event.new), "value")
        self.by_hand = widget(pn.widgets.Select, name="Another effect", options={})
        self.fit = button("Fit and add it", self._fit)
        self.none = text("<p class=quiet>Nothing was added to the model as given.</p>", styles=_TAKES_REST)
        title = text("<h3>Changes to the model</h3>", styles={"width": "auto", "flex": "0 1 12rem"})
        self.view = column(
            row(title, self.undo, self.redo, self.none, align_items="center"),
            self.added,
            self.show_given,
            self.given,
        )
        self.more = column(self.by_hand, self.fit)
        self._keys: tuple[EffectKey, ...] = ()
        self._sliders: list[dict[str, Any]] = []
        self._following = False

    def follow(self) -> None:
        """Show the present model."""
        history = self.live.bench.history
        if history is None:
            self.view.visible = self.more.visible = False
            return
        self.view.visible = self.more.visible = True
        self.undo.disabled, self.redo.disabled = history.before is None, history.after is None
        effects = history.current.effects
        keys = tuple(e.key for e in effects)
        if keys != self._keys or not self._sliders:
            self._build(effects, [e.key for e in history.given.effects])
            self._keys = keys
        self._following = True
        try:
            for applied, sliders in zip(effects, self._sliders, strict=True):
                for name, slider in sliders.items():
                    value = applied.parameters[name].value
                    if not slider.start <= value <= slider.end:
                        slider.start, slider.end = min(slider.start, value), max(slider.end, value)
                    slider.value = value
        finally:
            self._following = False
        self._offer()

    def _build(self, effects: tuple[AppliedEffect, ...], given: list[EffectKey]) -> None:
        model = self.live.bench.model
        cards, self._sliders = [], []
        for index, applied in enumerate(effects):
            head = text(f"<h4>{safe(w.capital(w.effect_phrase(applied.key)))}</h4>")
            sliders = {}
            for name, estimate in applied.parameters.items():
                low, high = reach(applied, name)
                unit = unit_text(estimate.unit)
                title = w.parameter_name(name) + (f" [{unit}]" if unit else "")
                slider = widget(
                    pn.widgets.EditableFloatSlider,
                    name=title,
                    start=low,
                    end=high,
                    step=(high - low) / _STEPS,
                    value=estimate.value,
                    format="0.00000" if high - low < 0.01 else "0.0000",
                )
                # what it is made of dresses by itself
                for part in (slider._label, slider._slider, slider._value_edit):
                    part.stylesheets = slider.stylesheets
                slider.param.watch(lambda event, i=index, n=name: self._moved(i, n, event.new), "value")
                slider.param.watch(lambda event: self._let_go(), "value_throttled")
                sliders[name] = slider
            remove = button(f"Remove {w.effect_phrase(applied.key)}", lambda i=index: self._remove(i))
            cards.append(column(head, *sliders.values(), remove, css_classes=["effect"], styles=_CARD))
            self._sliders.append(sliders)
        count = sum(1 for e in effects[: len(given)] if e.key in given)  # some of the file's may be gone
        self.given[:], self.added[:] = cards[:count], cards[count:]
        self.none.visible = not cards[count:]
        self.show_given.visible = count > 0
        self.show_given.name = f"Show the {count} effect{'s' * (count > 1)} of the model as given"
        self._places = places(model)

    def _offer(self) -> None:
        takes = self.live.takes
        options = {w.capital(w.effect_phrase(key)): key for key in self._places if takes(key)}
        if list(options) != list(self.by_hand.options):
            self.by_hand.options = dict(sorted(options.items()))
        idle = self.live.work is None and self.live.bench.chosen is not None
        self.fit.disabled = not idle

    def _moved(self, index: int, name: str, value: float) -> None:
        if self._following or value is None:
            return
        effects = self.live.bench.model.effects
        if index < len(effects) and effects[index].parameters[name].value != value:
            self.live.do(lambda: self.live.bench.set_value(index, name, value))

    def _let_go(self) -> None:
        if not self._following and self.live.bench.history is not None:
            self.live.bench.history.settle()

    def _remove(self, index: int) -> None:
        self.live.do(lambda: self.live.bench.remove(index))

    def _step(self, which: str) -> None:
        history = self.live.bench.history
        if history is not None:
            self.live.do(getattr(history, which))

    def _fit(self) -> None:
        if self.by_hand.value is not None:
            self.live.fit(self.by_hand.value)


def reach(applied: AppliedEffect, name: str) -> tuple[float, float]:
    """Return the range of a slider: from no effect to twice the present value, within physical bounds."""
    parameter = next(p for p in effect_named(applied.key.effect).parameters if p.name == name)
    estimate = applied.parameters[name]
    away = abs(estimate.value - parameter.neutral)
    away = away or (5.0 * estimate.std if np.isfinite(estimate.std) else 0.0)
    away = away or 0.1 * max(abs(parameter.neutral), 0.1)
    wide = 2.0 * away
    low = max(parameter.lower, parameter.neutral - (wide if parameter.lower < parameter.neutral else 0.0))
    high = min(parameter.upper, parameter.neutral + wide)
    return min(low, estimate.value), max(high, estimate.value)
