from __future__ import annotations

import queue
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from workbench.rigs import VirtualLeg, demo_experiments
from workbench.rigs.hidden import HiddenEffect

if TYPE_CHECKING:
    from workbench.ui.live import Live

pytest.importorskip("panel")

FRICTION = 0.25  # N m, of the knee's drive


@pytest.fixture(scope="session")
def leg_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A few seconds of a leg that hides friction: ``slow.toml`` and ``validation.toml``."""
    folder = tmp_path_factory.mktemp("leg")
    short = [
        replace(e, reference=e.reference[:3000], feedforward=e.feedforward[:3000])
        for e in demo_experiments(0)
        if e.name in ("slow", "validation")
    ]
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": FRICTION})
    VirtualLeg((hidden,), seed=0).record_to(folder, short)
    return folder


@dataclass
class Loop:
    waiting: queue.Queue[Callable[[], Any]] = field(default_factory=queue.Queue)

    def until(self, condition: Callable[[], Any], seconds: float = 90.0) -> None:
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, "it never came true"
            try:
                self.waiting.get(timeout=0.05)()
            except queue.Empty:
                continue


@pytest.fixture
def loop() -> Loop:
    return Loop()


@pytest.fixture
def live(leg_folder: Path, tmp_path: Path, loop: Loop) -> Iterator[Live]:
    from workbench.ui import Bench, Shelf  # needs Panel
    from workbench.ui.live import Live

    bench = Bench(Shelf.of(None, [], leg_folder), tmp_path)
    live = Live(bench, loop.waiting.put, lambda seconds, then: loop.waiting.put(then))
    yield live
    live.close()
