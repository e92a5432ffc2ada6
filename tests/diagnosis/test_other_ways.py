"""When which other beginning is asked for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from workbench.core import EffectKey
from workbench.diagnosis import other_ways, search
from workbench.diagnosis.ways import Quest, Way
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

from .rig import applied, searched_from

LEG = load_model("leg")


def way(**values: Any) -> Way:
    """A place on a way of one stage."""
    return cast(Way, SimpleNamespace(stages=("first",), current=None, data=None, **values))


def test_what_the_torque_shows_plainly_goes_before_all_else(monkeypatch: pytest.MonkeyPatch) -> None:
    found = way()
    monkeypatch.setattr(other_ways, "_plainly_by_torque", lambda *_: found)
    quest = cast(Quest, SimpleNamespace(start=None, data=None))
    assert other_ways.otherwise(way(), quest) is found


def test_the_torque_is_asked_too_where_most_is_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Way] = []

    def shown(at: Way, quest: Quest) -> Way:
        asked.append(at)
        return at

    monkeypatch.setattr(search, "what_the_torque_shows", shown)
    key = EffectKey("viscous_damping", "knee")
    hidden = HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3})
    searched_from(monkeypatch, LEG, [hidden], applied(LEG, key, damping=0.28))
    assert [s.added for at in asked for s in at.stages] == [key]


@pytest.mark.parametrize("near", [True, False])
def test_where_hardly_more_than_noise_is_left_no_more_is_asked(
    monkeypatch: pytest.MonkeyPatch, near: bool
) -> None:
    here, further = way(), way()
    monkeypatch.setattr(other_ways, "nearly_at_floor", lambda *_: near)
    monkeypatch.setattr(other_ways, "onwards", lambda *_, **__: further)
    monkeypatch.setattr(other_ways, "with_last", lambda at, *_: at)
    led = other_ways._through(here, cast(Quest, SimpleNamespace(seed=0)))
    assert led is (here if near else further)
