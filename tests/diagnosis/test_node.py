"""Places on the way of a search."""

from __future__ import annotations

from dataclasses import replace

import pytest

from workbench.core import EffectKey
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.diagnosis.node import scene_at
from workbench.diagnosis.screening import compliance
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

from .rig import applied, asked, recordings

LEG = load_model("leg")
SOFT = HiddenEffect("joint_compliance", "knee", parameters={"stiffness": 91.0, "damping": 0.12})


def test_where_a_search_comes_back_to_nothing_is_worked_out_again(monkeypatch: pytest.MonkeyPatch) -> None:
    training, _ = recordings(SOFT)
    quest = asked(LEG, training[:1])
    tried = [
        Hypothesis(LEG, (applied(LEG, EffectKey("viscous_damping", "knee"), damping=d),)) for d in (0.1, 0.2)
    ]
    one, other = fit(tried, quest.data, 1)
    assert one is not None and other is not None
    here = scene_at(one, quest.data, quest)
    assert scene_at(replace(one, trained=0.0), quest.data, quest) is here
    assert scene_at(other, quest.data, quest) is not here
    first = compliance.what_gives_way(here, 1, 1.0, one.hypothesis.free)
    monkeypatch.setattr(compliance, "_shares", lambda *_: pytest.fail("asked a second time"))
    again = compliance.what_gives_way(scene_at(one, quest.data, quest), 1, 100.0, one.hypothesis.free)
    assert first and [(c.key, c.judged) for c in again] == [(c.key, 100.0 * c.judged) for c in first]
