"""Activities of the workbench: runs that follow a slider, selection, and work that can be stopped."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from workbench.core import Diagnosis, EffectKey
from workbench.diagnosis import diagnose, fit_effect, states_gain
from workbench.models import AppliedEffect, Model
from workbench.report.wording import capital, effect_phrase

from .bench import Chosen
from .following import Following
from .worker import Worker


@dataclass
class Live(Following):
    """The bench and its activities.

    Attributes:
        work: what the worker does, in words; None where it rests.
        began: when it began, by `time.monotonic` [s].
        loading: whether what was chosen is being read.
    """

    work: str | None = None
    began: float = 0.0
    loading: bool = False
    worker: Worker = field(default_factory=Worker)
    _turn: object = None

    def choose(self, model: str, recordings: tuple[str, ...], held_out: str | None) -> None:
        """Read and use a selection; if it cannot be read, nothing changes."""
        self.loading = True
        self.say("Reading the recordings …" if recordings else "")

        def read() -> Chosen:
            return self.bench.read(model, recordings, held_out)

        def took(chosen: Chosen) -> None:
            self.loading = False
            self.take(chosen)
            self.say("")

        def refused(text: str) -> None:
            self.loading = False
            self.say(text, wrong=True)
            self.tell("inputs")  # the page goes back to what is chosen

        self._on(self._quick, read, took, refused)

    def take(self, chosen: Chosen) -> None:
        """Start with what was read."""
        self.stop()
        self.bench.choose(chosen)
        self.given = self.now = None
        self.focus = min(self.focus, len(chosen.recordings) - 1)
        self.tell("inputs")
        self._changed()

    def diagnose(self) -> None:
        """Start a diagnosis of the present model."""
        chosen = self.bench.chosen
        if chosen is None:
            self.say("Choose a model and at least one recording first.", wrong=True)
            return
        model = self.bench.model

        def done(result: Diagnosis) -> None:
            self.bench.diagnosis, self.bench.diagnosed = result, model
            self.tell("diagnosis")

        self._work("starting", partial(diagnose, seed=self.bench.seed), (model, *chosen.split()), done)

    def fit(self, key: EffectKey) -> None:
        """Fit an effect to the recordings and add it."""
        chosen = self.bench.chosen
        if chosen is None:
            return
        model, phrase = self.bench.model, effect_phrase(key)

        def done(result: tuple[AppliedEffect, Model]) -> None:
            if self.bench.model is model:
                self.do(lambda: self.bench.take(f"adding {phrase}", result[1]))

        self._work(f"starting to fit {phrase}", fit_effect, (model, chosen.split()[0], key), done)

    def takes(self, key: EffectKey) -> bool:
        """Return whether an effect belongs in the model: gains that recordings state are corrected there."""
        chosen = self.bench.chosen
        return chosen is None or not states_gain(chosen.recordings, key)

    def stop(self) -> None:
        """Stop the present work at once."""
        if self.work is not None:
            self.worker.stop()
            self.work = None
            self.tell("work")

    def close(self) -> None:
        """Stop everything."""
        self.worker.close()
        for pool in (self._quick, self._slow, self._sight):
            pool.shutdown(wait=False, cancel_futures=True)

    def _work(
        self, first: str, work: Callable[..., Any], arguments: tuple[Any, ...], done: Callable[[Any], None]
    ) -> None:
        self.stop()
        self.work, self.began = first, time.monotonic()
        self.say("")
        self.tell("work")

        def heard(kind: str, content: Any) -> None:
            if self.work is None:
                return
            if kind == "progress":
                self.work = content
                self.tell("work")
                return
            self.work = None
            self.tell("work")
            if kind == "done":
                done(content)
            else:
                self.say(capital(content), wrong=True)

        turn = object()
        self._turn = turn

        def tell(kind: str, content: Any) -> None:
            self.post(lambda: heard(kind, content) if self._turn is turn else None)

        self.worker.start(work, arguments, tell)
