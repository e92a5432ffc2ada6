"""Places on the way of a search."""

from __future__ import annotations

from dataclasses import replace

from workbench.core import EffectKey
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.diagnosis.node import linearisation_at
from workbench.diagnosis.screening import compliance
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

from .rig import applied, asked, recordings

LEG = load_model("leg")
SOFT = HiddenEffect("joint_compliance", "knee", parameters={"stiffness": 91.0, "damping": 0.12})


def test_where_a_search_comes_back_to_nothing_is_made_again() -> None:
    training, _ = recordings(SOFT)
    problem = asked(LEG, training[:1])
    tried = [
        Hypothesis(LEG, (applied(LEG, EffectKey("viscous_damping", "knee"), damping=d),)) for d in (0.1, 0.2)
    ]
    one, other = fit(tried, problem.data, 1)
    assert one is not None and other is not None
    here = linearisation_at(one, problem.data, problem)
    assert linearisation_at(replace(one, training_loss=0.0), problem.data, problem) is here
    assert linearisation_at(other, problem.data, problem) is not here
    first = compliance.compliance_candidates(here, 1.0, one.hypothesis.free)
    again = linearisation_at(one, problem.data, problem)
    dearer = compliance.compliance_candidates(again, 100.0, one.hypothesis.free)
    assert first and [(c.key, c.test_loss) for c in dearer] == [(c.key, 100.0 * c.test_loss) for c in first]
    again.compliances[()] = []  # what was asked is not asked a second time
    assert compliance.compliance_candidates(again, 1.0, one.hypothesis.free) == []
