"""Where a search ends, whatever it simulates on the way."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

import workbench.diagnosis.search as search
from workbench.core import EffectKey, Estimate
from workbench.diagnosis.effort import Effort
from workbench.diagnosis.ways import Way, onwards
from workbench.models import AppliedEffect


def stage(effect: str, before: tuple[AppliedEffect, ...], **parameters: tuple[float, float]) -> Any:
    """One more effect, with its estimates."""
    key = EffectKey(effect, "knee")
    own = AppliedEffect(key, {k: Estimate(value, std, "") for k, (value, std) in parameters.items()})
    hypothesis = SimpleNamespace(added=(*before, own), free=(*before, own), stated=())
    return SimpleNamespace(added=key, fit=SimpleNamespace(hypothesis=hypothesis), data=f"with {effect}")


def test_last_effects_that_may_be_none_are_taken_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "rejudged", lambda fit, data: fit)
    friction = stage("coulomb_friction", (), torque=(0.2, 0.01))
    ripple = stage(
        "cogging", friction.fit.hypothesis.added, torque=(2e-4, 2e-4), order=(7.0, 0.1), phase=(3.0, 0.1)
    )
    lag = stage("current_loop_lag", (), time_constant=(5e-6, 2e-5))
    start, first, end = SimpleNamespace(), SimpleNamespace(), SimpleNamespace()

    def plain(*stages: Any) -> Way:
        return search._plain(Way(end, end, stages, done=True), start, first)  # type: ignore[arg-type]

    kept = plain(friction, ripple)
    assert (
        kept.stages == (friction,) and kept.current is friction.fit and kept.data == "with coulomb_friction"
    )
    assert not kept.done
    assert plain(lag) == Way(start, first)  # type: ignore[arg-type]
    assert plain(friction).current is end, "what stands out stays as it was"


def test_a_search_ends_where_it_has_been(monkeypatch: pytest.MonkeyPatch) -> None:
    def begun(text: str) -> None:
        raise AssertionError(f"went on: {text}")

    friction = stage("coulomb_friction", (), torque=(0.2, 0.01))
    way = Way(friction.fit, SimpleNamespace(effort=Effort()))  # type: ignore[arg-type]
    quest: Any = SimpleNamespace(start=None, progress=begun, limit=6)
    assert onwards(way, quest, met=[frozenset({friction.added})]) == way
    with pytest.raises(AssertionError, match="went on"):
        onwards(way, quest, met=[frozenset()])
