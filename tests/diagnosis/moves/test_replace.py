"""What was taken while another cause was missing is held against others once that cause is there."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.diagnosis.rig import SPRING_AND_DELAY, applied, searched_from
from workbench.core import EffectKey
from workbench.diagnosis.moves.replace import others_instead
from workbench.diagnosis.node import Way
from workbench.diagnosis.problem import Quest
from workbench.effects import load_model

LEG = load_model("leg")
PIN, DRIVE = (EffectKey("joint_compliance", "knee", place) for place in ("joint", "actuator"))
DELAY = EffectKey("sensor_delay", None)


def test_a_spring_at_the_drive_is_found_where_one_in_the_pin_was_taken_before_the_delay(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pin, late = applied(LEG, PIN, stiffness=85.0, damping=0.1), applied(LEG, DELAY, time=0.0012)
    found = searched_from(monkeypatch, LEG, SPRING_AND_DELAY, pin, late, behind=((DRIVE, 1.007),))
    assert found.consistent_after
    values = {a.key: a.values for a in found.final.hypothesis.free}
    assert values.keys() == {DRIVE, DELAY}
    assert values[DRIVE]["stiffness"] == pytest.approx(91.0, rel=0.01)
    last = found.stages[-1]
    assert last.added == DRIVE and last.dropped == (PIN,)
    assert dict(last.behind)[PIN] > 1.5, "how far the one given up is behind"

    def tried(text: str) -> None:
        raise AssertionError(text)

    quest = Quest(found.start, found.start_data, 6, 0, tried)
    far = tuple(replace(stage, behind=((PIN, 2.6),)) for stage in found.stages)
    way = Way(found.final, last.data, far)
    assert others_instead(way, quest) is way, "what was far behind is not tried"
    close = replace(way, stages=tuple(replace(stage, behind=((PIN, 1.1),)) for stage in found.stages))
    with pytest.raises(AssertionError, match="in place of"):
        others_instead(close, quest)
