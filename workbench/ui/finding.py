"""The diagnosis: its button, its progress, its findings, and what can be added with a click."""

from __future__ import annotations

import time
from typing import Any

from workbench.core import Diagnosis, EffectKey, Finding
from workbench.report import sentence
from workbench.report import wording as w
from workbench.report.answer import mend_sentences
from workbench.report.numbers import interval, number, percent

from .live import Live
from .widgets import button, column, safe, text

_RANKED = 6


class Findings:
    """What is missing, as far as the data show."""

    def __init__(self, live: Live) -> None:
        self.live = live
        self.start = button("Find what is missing", live.diagnose, kind="primary")
        self.stop = button("Stop", live.stop, kind="danger")
        self.progress = text()
        self.verdict, self.found = text(), column()
        self.view = column(self.start, self.stop, self.progress, self.found)
        self._shown: Diagnosis | None = None
        self._adders: list[tuple[Any, EffectKey, str]] = []

    def follow(self) -> None:
        """Show the progress and the findings."""
        busy = self.live.work is not None
        self.start.visible, self.stop.visible = not busy, busy
        self.start.disabled = self.live.bench.chosen is None
        self.tick()
        diagnosis = self.live.bench.diagnosis
        changed, self._shown = diagnosis is not self._shown, diagnosis
        self._sum_up()
        if changed:
            self._adders = []
            self.found[:] = [] if diagnosis is None else self._parts(diagnosis)
        for adder, key, name in self._adders:
            there = self.live.bench.has(key)
            adder.disabled = there or (busy and name.startswith("Fit"))
            adder.name = f"Added: {w.effect_phrase(key)}" if there else name

    def tick(self) -> None:
        """Update the progress line and its time."""
        if self.live.work is None:
            self.progress.object = ""
            return
        seconds = time.monotonic() - self.live.began
        self.progress.object = (
            f"<p class=working><progress aria-label='working'></progress> {safe(self.live.work)}"
            f" <span class=quiet>{seconds:.0f} s</span></p>"
        )

    def _sum_up(self) -> None:
        """What the diagnosis says; once all that it named is in the model, nothing of it is missing."""
        d, has = self._shown, self.live.bench.has
        if d is None:
            return
        tone, words = {"consistent": "good", "unexplained": "open"}.get(d.verdict, "missing"), sentence(d)
        if d.findings and all(has(f.key) for f in d.findings):
            tone, words = "added", "The effects that were found are in the model now."
        elif self.live.bench.told() is None:
            tone, words = "open", f"Before the last changes of the model: {sentence(d)}"
        self.verdict.object = f"<p class='verdict {tone}'>{safe(words)}</p>"

    def _parts(self, d: Diagnosis) -> list[Any]:
        parts: list[Any] = [self.verdict, *(text(f"<p>{safe(line)}</p>") for line in mend_sentences(d))]
        for finding in d.findings:
            parts += [self._card(finding)]
        if sum(map(self._takes, d.findings)) > 1:
            parts.append(button("Add all of them", self._add_all))
        if d.next_experiment:
            parts.append(text(f"<p><b>Measure next:</b> {safe(d.next_experiment)}</p>"))
        named = {f.key for f in d.findings}
        others = [(k, s) for k, s in d.ranking if k not in named and self.live.takes(k)][:_RANKED]
        if others:
            about = (
                "The share of the squared error above the noise that each removes by itself, on data that it "
                "was not fitted to, with each signal divided by its noise"
            )
            parts.append(text(f"<h3>Other explanations</h3><p class=quiet>{about}</p>"))
            parts += [self._other(key, share) for key, share in others]
        return parts

    def _card(self, f: Finding) -> Any:
        values = "".join(
            f"<tr><th scope=row>{safe(w.parameter_name(n))}</th><td>{safe(interval(e))}</td></tr>"
            for n, e in f.parameters.items()
        )
        lines = [w.lookalike_sentence(f.indistinguishable_from)]
        if f.holdout_error_after is not None:
            lines.append(w.holdout_sentence(f.holdout_error_before, f.holdout_error_after))
        told = "".join(f"<p>{safe(line)}</p>" for line in lines if line)
        evidence = "".join(f"<li>{safe(w.capital(e))}</li>" for e in f.evidence)
        head = (
            f"<h3>{safe(w.capital(w.effect_phrase(f.key)))} <span class=quiet>"
            f"{safe(percent(f.probability))} probable</span></h3><table>{values}"
            f"<tr><th scope=row>error on the fitted data</th><td>{number(f.error_after)}</td></tr>"
            f"</table>{told}"
        )
        tail = f"<details><summary>Evidence</summary><ul>{evidence}</ul></details>" if evidence else ""
        if self._takes(f):
            add = self._adder(f"Add {w.effect_phrase(f.key)}", f.key, lambda: self._add(f), kind="primary")
        else:
            add = text("<p>Correct it in the files of the recordings, and choose these again.</p>")
        return column(text(head), add, text(tail), css_classes=["effect"])

    def _other(self, key: EffectKey, share: float) -> Any:
        share = min(1.0, max(0.0, share))
        full = f"<div class=share><span style='width:{100.0 * share:.1f}%'></span></div>"
        bar = f"{full}<small>{safe(percent(share))}</small>"
        fit = self._adder(f"Fit {w.effect_phrase(key)}", key, lambda: self.live.fit(key))
        return column(fit, text(f"<div class=bar>{bar}</div>"))

    def _adder(self, name: str, key: EffectKey, act: Any, kind: str = "default") -> Any:
        out = button(name, act, kind=kind)
        self._adders.append((out, key, name))
        return out

    def _takes(self, f: Finding) -> bool:
        return self.live.takes(f.key)

    def _add(self, f: Finding) -> None:
        self.live.do(lambda: self.live.bench.add_finding(f))

    def _add_all(self) -> None:
        diagnosis = self.live.bench.diagnosis
        for f in diagnosis.findings if diagnosis else ():
            if self._takes(f) and not self.live.bench.has(f.key):
                self._add(f)
