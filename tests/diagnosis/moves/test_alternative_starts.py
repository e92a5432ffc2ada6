"""When which other beginning is asked for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from tests.diagnosis.rig import applied, searched_from
from workbench.core import EffectKey
from workbench.diagnosis import search
from workbench.diagnosis.moves import alternative_starts
from workbench.diagnosis.node import Way
from workbench.diagnosis.problem import Quest
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

LEG = load_model("leg")
DAMPING, FRICTION = (EffectKey(effect, "knee") for effect in ("viscous_damping", "coulomb_friction"))
DAMPED = HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3})


def way(**values: Any) -> Way:
    """A place on a way of one stage."""
    return cast(Way, SimpleNamespace(stages=("first",), current=None, data=None, **values))


def test_what_the_torque_shows_plainly_goes_before_all_else(monkeypatch: pytest.MonkeyPatch) -> None:
    found = way()
    monkeypatch.setattr(alternative_starts, "_plainly_by_torque", lambda *_: found)
    quest = cast(Quest, SimpleNamespace(start=None, data=None))
    assert alternative_starts.otherwise(way(), quest) is found


def test_the_torque_is_asked_too_where_most_is_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Way] = []

    def shown(at: Way, quest: Quest) -> Way:
        asked.append(at)
        return at

    monkeypatch.setattr(search, "what_the_torque_shows", shown)
    searched_from(monkeypatch, LEG, [DAMPED], applied(LEG, DAMPING, damping=0.28))
    assert [s.added for at in asked for s in at.stages] == [DAMPING]


@pytest.mark.parametrize("near", [True, False])
def test_where_hardly_more_than_noise_is_left_no_more_is_asked(
    monkeypatch: pytest.MonkeyPatch, near: bool
) -> None:
    here, further = way(), way()
    monkeypatch.setattr(alternative_starts, "nearly_at_floor", lambda *_: near)
    monkeypatch.setattr(alternative_starts, "onwards", lambda *_, **__: further)
    monkeypatch.setattr(alternative_starts, "with_last", lambda at, *_: at)
    led = alternative_starts._through(here, cast(Quest, SimpleNamespace(seed=0)))
    assert led is (here if near else further)


@pytest.mark.parametrize(
    ("done", "near", "sure", "better", "taken"),
    [
        (False, False, True, True, True),
        (True, False, True, True, False),
        (False, True, True, True, False),
        (False, False, False, True, False),
        (False, False, True, False, False),
    ],
)
def test_what_a_basic_effect_went_before_is_begun_with_where_more_than_noise_is_left_and_it_mends_that(
    monkeypatch: pytest.MonkeyPatch, done: bool, near: bool, sure: bool, better: bool, taken: bool
) -> None:
    here, other = way(done=done), way(done=True)
    monkeypatch.setattr(alternative_starts, "_refined", lambda *_: iter((other,)))
    monkeypatch.setattr(alternative_starts, "keys_of", lambda *_: frozenset())
    monkeypatch.setattr(alternative_starts, "nearly_at_floor", lambda *_: near)
    monkeypatch.setattr(alternative_starts, "_sure", lambda *_: sure)
    monkeypatch.setattr(alternative_starts, "mends", lambda *_: better)
    led = alternative_starts.what_was_passed_over(here, cast(Quest, SimpleNamespace()))
    assert led is (other if taken else here)


@pytest.mark.parametrize("came_later", [False, True])
def test_what_came_later_all_the_same_is_not_begun_with(
    monkeypatch: pytest.MonkeyPatch, came_later: bool
) -> None:
    better, other = EffectKey("asymmetric_friction", "knee"), way(done=True)
    first = SimpleNamespace(added=FRICTION, ranking=((better, 0.99), (FRICTION, 0.8)), fit=None)
    held = frozenset({FRICTION, better} if came_later else {FRICTION})
    monkeypatch.setattr(alternative_starts, "keys_of", lambda found: held if found == "end" else frozenset())
    monkeypatch.setattr(alternative_starts, "nearly_at_floor", lambda *_: False)
    monkeypatch.setattr(alternative_starts, "_through", lambda *_, **__: other)
    monkeypatch.setattr(alternative_starts, "_sure", lambda *_: True)
    monkeypatch.setattr(alternative_starts, "mends", lambda *_: True)
    here = cast(Way, SimpleNamespace(stages=(first,), current="end", data=None, done=False))
    quest = SimpleNamespace(start=None, data=SimpleNamespace(effort=SimpleNamespace(spent=False)))
    quest.progress = lambda text: None
    led = alternative_starts.what_was_passed_over(here, cast(Quest, quest))
    assert led is (here if came_later else other)


def test_what_was_passed_over_is_asked_where_most_is_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    other = searched_from(monkeypatch, LEG, [DAMPED], applied(LEG, DAMPING, damping=0.28))
    assert other.consistent_after

    def passed_over(at: Way, quest: Quest) -> Way:
        assert [s.added for s in at.stages] == [FRICTION]
        return Way(other.final, other.stages[-1].data, other.stages, done=True)

    monkeypatch.setattr(search, "what_was_passed_over", passed_over)
    monkeypatch.setattr(search, "holds", lambda *_: True)
    found = searched_from(monkeypatch, LEG, [DAMPED], applied(LEG, FRICTION, torque=0.1))
    assert [a.key for a in found.final.hypothesis.free] == [DAMPING]
