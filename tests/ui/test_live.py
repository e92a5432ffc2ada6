"""What happens when, without a page: the loop of the server is a queue."""

from __future__ import annotations

import queue
from collections.abc import Callable

import pytest

from workbench.core import EffectKey, Estimate
from workbench.models import AppliedEffect
from workbench.ui.live import Live
from workbench.ui.worker import Worker

from .conftest import FRICTION, Loop
from .work import forever, refuse

KNEE = EffectKey("coulomb_friction", "knee")


def friction(torque: float) -> AppliedEffect:
    return AppliedEffect(KNEE, {"torque": Estimate(torque, 0.01, "N*m")})


def test_runs_follow_the_model_and_the_noise_when_it_rests(live: Live, loop: Loop) -> None:
    heard: list[str] = []
    end = live.listen(heard.append)
    live.choose("leg", ("slow", "validation"), None)
    loop.until(lambda: live.now and live.now.comparison)
    assert live.now is live.given and live.now is not None
    before = live.now.error
    assert before == pytest.approx(live.now.comparison.error)  # type: ignore[union-attr]
    assert live.do(lambda: live.bench.add(friction(0.1)))
    index = len(live.bench.model.effects) - 1
    for torque in (0.15, 0.2, FRICTION):  # faster than anything can be simulated
        assert live.do(lambda torque=torque: live.bench.set_value(index, "torque", torque))
    loop.until(lambda: live.now and live.now.comparison)
    assert live.now.model is live.bench.model and live.given is not live.now
    assert live.now.comparison.consistent and live.now.error < 0.6 * before  # type: ignore[union-attr]
    assert {"inputs", "model", "runs", "comparison", "message"} <= set(heard)
    live.do(live.bench.history.undo)  # type: ignore[union-attr]
    live.do(live.bench.history.undo)  # type: ignore[union-attr]
    assert live.now is live.given, "back at the start nothing is computed again"
    count = len(heard)
    end()
    live.tell("model")
    assert len(heard) == count


def test_what_goes_wrong_is_said_and_loses_nothing(live: Live, loop: Loop) -> None:
    live.choose("leg", ("slow",), None)
    loop.until(lambda: live.now and live.now.entries)
    chosen = live.bench.chosen
    live.choose("actuator", ("slow",), None)
    loop.until(lambda: live.message[1])
    assert "axes" in live.message[0] and live.bench.chosen is chosen
    live.do(lambda: live.bench.add(friction(0.2)))
    assert live.message == ("", False)
    index = len(live.bench.model.effects) - 1
    assert not live.do(lambda: live.bench.set_value(index, "torque", -1.0))
    assert live.message[1] and live.bench.model.effects[index].values == {"torque": 0.2}
    values = {name: Estimate(-0.1, 0, "kg*m^2") for name in ("M11", "M12", "M22")}
    live.do(lambda: live.bench.add(AppliedEffect(EffectKey("linkage_inertia", None), values)))
    loop.until(lambda: live.now and live.now.failed)
    assert live.message[1]
    live.do(live.bench.history.undo)  # type: ignore[union-attr]
    loop.until(lambda: live.now and live.now.entries)
    assert live.bench.has(KNEE)


def test_an_effect_that_is_fitted_is_named_as_the_page_names_it(
    live: Live, loop: Loop, monkeypatch: pytest.MonkeyPatch
) -> None:
    live.choose("leg", ("slow",), None)
    loop.until(lambda: live.now and live.now.entries)
    tell: list[Callable[[str, str], None]] = []
    monkeypatch.setattr(live.worker, "start", lambda work, arguments, told: tell.append(told))
    key = EffectKey("torque_saturation", "knee")
    live.fit(key)
    assert live.work == "starting to fit torque saturation on the knee drive"
    tell[0]("progress", "fitting torque saturation on the knee drive")
    loop.until(lambda: live.work == "fitting torque saturation on the knee drive")
    tell[0]("failed", "torque saturation on the knee drive does not lower the error on these recordings")
    loop.until(lambda: live.message[1])
    assert live.message[0].startswith("Torque saturation on the knee drive does not lower the error")


def test_work_stops_at_once_and_others_may_follow() -> None:
    worker, heard = Worker(), queue.Queue()
    worker.start(forever, (), lambda kind, content: heard.put((kind, content)))
    assert heard.get(timeout=60) == ("progress", "begun")
    process = worker._process
    worker.stop()
    assert process.exitcode is not None
    worker.start(refuse, (), lambda kind, content: heard.put((kind, content)))
    kind, content = heard.get(timeout=60)
    assert kind == "failed" and "ZeroDivisionError" in content
    process = worker._process
    worker.stop()
    assert process.is_alive(), "it rests, and need not start anew"
    worker.start(forever, (), lambda kind, content: heard.put((kind, content)))
    assert heard.get(timeout=60) == ("progress", "begun")
    process.kill()
    kind, content = heard.get(timeout=60)
    assert kind == "failed" and "try again" in content
    worker.close()
