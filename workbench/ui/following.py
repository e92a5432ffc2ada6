"""Runs of a model after its changes: simulated at once, compared with the noise floor when it rests.

Lives on one thread, that of the server's loop; computing is done on others, which post their results back.
Every page shows this one state, so that a page that is closed or loaded again loses nothing.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from workbench.core import Comparison, Recording, WorkbenchError

from .bench import Bench, Chosen
from .runs import Runs
from .stretch import run_stretch, stretch_rows

Post = Callable[[Callable[[], None]], None]
Later = Callable[[float, Callable[[], None]], Any]

_SOON_S = 0.8  # without a change, before what is out of sight is simulated too
_REST_S = 0.6  # without a change, before the slow comparison starts


@dataclass
class Following:
    """The bench, the runs of its model, and its listeners.

    Attributes:
        bench: what is chosen and changed.
        post: runs a function on this object's thread.
        later: runs it there after a number of seconds.
        given, now: runs of the model as given, and with the changes.
        message: the last thing that went wrong or was done, and whether it went wrong.
        took: seconds from a change to the curve on the bench.
        focus: the recording that is looked at, simulated first.
        window: from when to when it is looked at [s]; None where no page has said.
    """

    bench: Bench
    post: Post
    later: Later
    given: Runs | None = None
    now: Runs | None = None
    message: tuple[str, bool] = ("", False)
    took: float = 0.0
    focus: int = 0
    window: tuple[float, float] | None = None
    _listeners: list[Callable[[str], None]] = field(default_factory=list)
    _quick: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1))
    _slow: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1))
    _sight: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1))
    _glancing: bool = False
    _running: bool = False
    _change: int = 0

    def listen(self, listener: Callable[[str], None]) -> Callable[[], None]:
        """Add a listener for changes: ``inputs``, ``model``, ``runs``, ``comparison``, ``work``, ``message``.

        Returns:
            What ends it.
        """
        self._listeners.append(listener)
        return lambda: self._listeners.remove(listener) if listener in self._listeners else None

    def tell(self, what: str) -> None:
        """Inform every listener."""
        for listener in tuple(self._listeners):
            listener(what)

    def say(self, text: str, *, wrong: bool = False) -> None:
        """Show a message."""
        self.message = (text, wrong)
        self.tell("message")

    def do(self, change: Callable[[], None]) -> bool:
        """Change the model of the bench; an impossible change shows a message, and nothing is lost."""
        try:
            change()
        except WorkbenchError as error:
            self.say(str(error), wrong=True)
            return False
        if self.message[1]:
            self.say("")
        self.tell("model")
        self._changed()
        return True

    def look_at(self, index: int) -> None:
        """Set the recording that is simulated first."""
        self.focus = index

    def _changed(self) -> None:
        self._change += 1
        change = self._change
        if self._in_sight() is None:
            self._simulate()
            return
        self._follow_model()
        self._glance()
        self.later(_SOON_S, lambda: self._simulate() if change == self._change else None)

    def _in_sight(self) -> tuple[slice, Recording] | None:
        """Rows that are looked at and the run drawn there; None where the whole is simulated at once."""
        chosen, now = self.bench.chosen, self.now
        if chosen is None or now is None or self.focus >= len(chosen.recordings):
            return None
        drawn = now.shown.get(self.focus) or now.seen.get(self.focus)
        rows = stretch_rows(chosen.recordings[self.focus], self.window)
        return None if drawn is None or rows is None else (rows, drawn)

    def _glance(self) -> None:
        """Simulate what is in sight; of changes that come meanwhile the last one counts."""
        chosen, now, sight = self.bench.chosen, self.now, self._in_sight()
        if self._glancing or chosen is None or now is None or sight is None or self.focus in now.shown:
            return
        focus, (rows, drawn), started = self.focus, sight, time.perf_counter()
        self._glancing = True

        def made(run: Recording | None) -> None:
            self._glancing = False
            if chosen is not self.bench.chosen or self.now is None:
                return
            if run is not None and focus not in self.now.shown:
                self.now.seen[focus] = run
                self.took = time.perf_counter() - started
                self.tell("runs")
            if now is not self.now:
                self._glance()

        def failed(text: str) -> None:
            del text  # the run of the whole says it
            self._glancing = False

        self._on(self._sight, lambda: run_stretch(now.model, chosen.replay, focus, rows, drawn), made, failed)

    def _follow_model(self) -> None:
        """The runs of the model as it is now, with none made yet where it is new."""
        history = self.bench.history
        if history is None:
            return
        self.given = self.given or Runs(history.given)
        if not history.changed:
            self.now = self.given
        elif self.now is None or self.now.model is not history.current:
            self.now = Runs(history.current, seen={**self.now.seen, **self.now.shown} if self.now else {})

    def _simulate(self) -> None:
        """See to it that the runs follow the model; of changes that come meanwhile the last one counts."""
        chosen = self.bench.chosen
        if chosen is None or self.bench.history is None:
            return
        self._follow_model()
        assert self.given is not None and self.now is not None
        if self._running:
            return
        count = len(chosen.recordings)
        runs = next((r for r in (self.given, self.now) if not r.failed and len(r.shown) < count), None)
        if runs is None:
            self.tell("runs")
            change = self._change
            self.later(_REST_S, lambda: self._compare() if change == self._change else None)
            return
        missing = [i for i in range(count) if i not in runs.shown]
        # the one that is looked at follows a slider, the others once it rests
        part = [self.focus] if self.focus in missing else missing
        self._running, started = True, time.perf_counter()

        def simulated(made: tuple[Recording, ...]) -> None:
            self._running = False
            if chosen is self.bench.chosen:
                self._took(chosen, runs, dict(zip(part, made, strict=True)))
                self.took = time.perf_counter() - started if part == [self.focus] else self.took
                self.tell("runs")
            self._simulate()

        def failed(text: str) -> None:
            self._running, runs.failed = False, True
            self.say(text, wrong=True)
            self._simulate()

        self._on(self._quick, lambda: self.bench.simulate(runs.model, chosen, part), simulated, failed)

    def _took(self, chosen: Chosen, runs: Runs, made: dict[int, Recording]) -> None:
        runs.shown.update(made)
        if runs is not self.given and self.now is not None:
            self.now.seen.update(made)  # though a slider has moved on, so that its curve moves along
        if len(runs.shown) == len(chosen.recordings):
            ordered = [runs.shown[i] for i in range(len(chosen.recordings))]
            like = self.given.comparison if self.given else None
            runs.entries = self.bench.entries(chosen, ordered, like)
            runs.error = self.bench.error(chosen, ordered)

    def _compare(self) -> None:
        """The noise floor and where the error sits, for the model that now rests."""
        chosen = self.bench.chosen
        open_ = (r for r in (self.given, self.now) if r and r.entries and r.comparison is None)
        runs = next(open_, None)
        if chosen is None or runs is None:
            return

        def compared(comparison: Comparison) -> None:
            if chosen is not self.bench.chosen:
                return
            runs.comparison = comparison
            runs.entries, runs.error = comparison.recordings, comparison.error
            self.tell("comparison")
            if runs is not self.now:
                self._compare()

        def failed(text: str) -> None:
            self.say(text, wrong=True)

        self._on(self._slow, lambda: self.bench.compare(runs.model, chosen), compared, failed)

    def _on(
        self,
        pool: ThreadPoolExecutor,
        compute: Callable[[], Any],
        done: Callable[[Any], None],
        failed: Callable[[str], None],
    ) -> None:
        """Compute elsewhere; what comes of it is taken here."""

        def run() -> None:
            try:
                result = compute()
            except WorkbenchError as error:
                text = str(error)
                self.post(lambda: failed(text))
            except Exception as error:
                text = f"This is a fault of workbench: {type(error).__name__}: {error}"
                self.post(lambda: failed(text))
            else:
                self.post(lambda: done(result))

        pool.submit(run)

    def responses(
        self, compute: Callable[[], Any], done: Callable[[Any], None], failed: Callable[[str], None]
    ) -> None:
        """Compute something for one page, after the work for all pages."""
        self._on(self._slow, compute, done, failed)
