"""What was taken while another cause was missing is held against others once that cause is there."""

from __future__ import annotations

from dataclasses import replace

import pytest

from workbench.core import EffectKey, Estimate
from workbench.diagnosis.data import Data, gather
from workbench.diagnosis.fit import fit
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.diagnosis.instead import others_instead
from workbench.diagnosis.search import starting_fit
from workbench.diagnosis.sensitivity import Scene
from workbench.diagnosis.stage import Stage
from workbench.diagnosis.ways import Quest, Way, with_stages
from workbench.effects import load_model
from workbench.models import AppliedEffect
from workbench.rigs import HiddenEffect

from .rig import recordings

LEG = load_model("leg")
PIN, DRIVE = (EffectKey("joint_compliance", "knee", place) for place in ("joint", "actuator"))
DELAY = EffectKey("sensor_delay", None)


def stage(data: Data, *effects: AppliedEffect, behind: tuple[tuple[EffectKey, float], ...] = ()) -> Stage:
    """One more effect as a search would have taken it: the last of some, all fitted."""
    (found,) = fit([Hypothesis(LEG, effects)], data)
    assert found is not None
    return Stage(effects[-1].key, found, data, 1.0, (), (), (), (), behind, (1, 1), True)


def test_a_spring_at_the_drive_is_found_where_one_in_the_pin_was_taken_before_the_delay() -> None:
    spring = HiddenEffect("joint_compliance", "knee", parameters={"stiffness": 91.0, "damping": 0.12})
    delay = HiddenEffect("sensor_delay", parameters={"time": 0.0013})
    training, held_out = recordings(spring, delay)
    data, runs = gather(LEG, training, held_out, seed=0)
    start = starting_fit(LEG, data, runs.clean)
    scene = Scene.of(LEG, data, runs.clean, len(data.recordings))
    quest = Quest(start, data, scene, (), 6, 0, lambda text: None)
    units = {"stiffness": "N*m/rad", "damping": "N*m*s/rad", "time": "s"}

    def applied(key: EffectKey, **values: float) -> AppliedEffect:
        return AppliedEffect(key, {k: Estimate(v, 0.0, units[k]) for k, v in values.items()})

    pin, late = applied(PIN, stiffness=85.0, damping=0.1), applied(DELAY, time=0.0012)
    stages = stage(data, pin, behind=((DRIVE, 1.007),)), stage(data, pin, late)
    way = with_stages(Way(start, data), stages, 0)
    assert not way.done
    ended = others_instead(way, quest)
    assert ended.done
    found = {a.key: a.values for a in ended.current.hypothesis.free}
    assert found.keys() == {DRIVE, DELAY}
    assert found[DRIVE]["stiffness"] == pytest.approx(91.0, rel=0.01)
    last = ended.stages[-1]
    assert last.added == DRIVE and last.dropped == (PIN,)
    assert dict(last.behind)[PIN] > 1.5, "how far the one given up is behind"
    same = replace(way, stages=tuple(replace(s, behind=((DRIVE, 2.6),)) for s in way.stages))
    assert others_instead(same, quest) is same, "what was far behind is not tried"
