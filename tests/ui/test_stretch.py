"""While a slider moves, the stretch that is looked at is simulated anew, and only then the whole."""

from __future__ import annotations

from dataclasses import replace
from threading import Event
from typing import TYPE_CHECKING, Any

import numpy as np

from tests.report import build
from workbench.core import EffectKey, Estimate
from workbench.models import AppliedEffect
from workbench.ui.stretch import stretch_rows

from .conftest import Loop

if TYPE_CHECKING:
    import pytest

    from workbench.recordings import Recording
    from workbench.ui.live import Live


def test_what_is_in_sight_follows_first_and_is_the_whole_run_s(
    live: Live, loop: Loop, monkeypatch: pytest.MonkeyPatch
) -> None:
    live.choose("leg", ("slow",), None)
    loop.until(lambda: live.now and live.now.comparison)
    friction = AppliedEffect(EffectKey("coulomb_friction", "knee"), {"torque": Estimate(0.2, 0.01, "N*m")})
    live.do(lambda: live.bench.add(friction))
    loop.until(lambda: live.now and live.now.shown)
    assert live.now is not None
    old = live.now.shown[0].position
    live.window = (2.0, 2.4)
    index = len(live.bench.model.effects) - 1
    looked_at, simulate = Event(), live.bench.simulate

    def after_the_look(*run: Any) -> tuple[Recording, ...]:
        """The whole run as on a slow machine: it ends once what is in sight was there."""
        assert looked_at.wait(60.0), "what is in sight waits for the whole"
        return simulate(*run)

    monkeypatch.setattr(live.bench, "simulate", after_the_look)
    live.do(lambda: live.bench.set_value(index, "torque", 0.3))
    loop.until(lambda: live.now and live.now.seen.get(0) is not None and live.now.seen[0].position is not old)
    assert not live.now.shown, "the whole is not there yet"
    seen = live.now.seen[0].position
    looked_at.set()
    rows = slice(2000, 2400)
    assert (seen[:1400] == old[:1400]).all(), "out of sight it is as it was"
    loop.until(lambda: live.now and live.now.shown)
    whole = live.now.shown[0].position
    change = np.abs(whole[rows] - old[rows]).max()
    assert change > 0 and np.abs(seen[rows] - whole[rows]).max() < 0.05 * change


def test_a_stretch_that_is_most_of_a_recording_is_no_quicker(live: Live, loop: Loop) -> None:
    live.choose("leg", ("slow",), None)
    loop.until(lambda: live.now and live.now.comparison)
    assert live.bench.chosen is not None
    recording = live.bench.chosen.recordings[0]
    assert stretch_rows(recording, None) is None and stretch_rows(recording, (0.0, 3.0)) is None
    assert stretch_rows(recording, (1.0, 1.5)) == slice(500, 1501)
    assert stretch_rows(recording, (0.0, 0.5)) == slice(0, 501)


def test_no_words_contradict_an_error_above_the_noise() -> None:
    from workbench.ui.summary import where_words

    above = replace(build.comparison(0.0), where=())
    assert "no larger than the noise" not in where_words(above) and "above the noise" in where_words(above)
    assert "no larger than the noise" in where_words(build.comparison(0.25))
