"""The size of a gap by the loop's own runs, where the torque told it only roughly."""

from __future__ import annotations

import pytest

from workbench.core import EffectKey, Estimate
from workbench.diagnosis.data import gather
from workbench.diagnosis.fit import fit
from workbench.diagnosis.honing import honed
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.effects import load_model
from workbench.models import AppliedEffect
from workbench.rigs import HiddenEffect

from .rig import recordings

LEG = load_model("leg")
GAP = EffectKey("backlash", "hip")
UNITS = {"gap": "rad", "stiffness": "N*m/rad"}


def test_a_gap_is_brought_to_its_size() -> None:
    training, held_out = recordings(
        HiddenEffect("backlash", "hip", parameters={"gap": 0.014, "stiffness": 350.0})
    )
    data, _ = gather(LEG, training, held_out, seed=0)
    rough = AppliedEffect(
        GAP, {k: Estimate(v, 0.0, UNITS[k]) for k, v in (("gap", 0.0132), ("stiffness", 310.0))}
    )
    (found,) = fit([Hypothesis(LEG, (rough,))], data, 1)
    assert found is not None
    better = honed(found, data)
    (gap,) = better.hypothesis.free
    assert gap.values["gap"] == pytest.approx(0.014, rel=0.02)
    assert gap.values["stiffness"] == pytest.approx(350.0, rel=0.05)
    assert better.judged < 0.7 * found.judged and better.trained < 0.7 * found.trained
    assert gap.parameters["gap"].std > 0.0, "how well it is known has not changed by the search"


def test_what_has_no_gap_is_left_alone() -> None:
    training, held_out = recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3}))
    data, _ = gather(LEG, training, held_out, seed=0)
    friction = AppliedEffect(
        EffectKey("viscous_damping", "knee"), {"damping": Estimate(0.28, 0.0, "N*m*s/rad")}
    )
    (found,) = fit([Hypothesis(LEG, (friction,))], data, 1)
    assert found is not None and honed(found, data) is found
