"""The size of a gap by the loop's own runs, where the torque told it only roughly."""

from __future__ import annotations

import pytest

from tests.diagnosis.rig import applied, asked, explored_from, recordings
from workbench.core import EffectKey
from workbench.diagnosis.data import gather
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.diagnosis.moves.grid_refinement import refined_on_grid
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

LEG = load_model("leg")


def test_a_gap_is_brought_to_its_size() -> None:
    hidden = HiddenEffect("backlash", "hip", parameters={"gap": 0.014, "stiffness": 350.0})
    rough = applied(LEG, EffectKey("backlash", "hip"), gap=0.0132, stiffness=310.0)
    found = explored_from(asked(LEG, *recordings(hidden)), rough, iterations=1)
    assert found.done
    (gap,) = found.current.hypothesis.free
    assert gap.values["gap"] == pytest.approx(0.014, rel=0.02)
    assert gap.values["stiffness"] == pytest.approx(350.0, rel=0.05)
    assert gap.parameters["gap"].std > 0.0, "how well it is known has not changed by the search"


def test_what_stands_beside_a_gap_is_fitted_to_its_end() -> None:
    gap = {"gap": 0.01, "stiffness": 400.0}
    training, held_out = recordings(
        HiddenEffect("backlash", "hip", parameters=gap),
        HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3}),
    )
    data, _ = gather(LEG, training, held_out, seed=0)
    free = (
        applied(LEG, EffectKey("viscous_damping", "knee"), damping=0.27),
        applied(LEG, EffectKey("backlash", "hip"), **gap),
    )
    (begun,) = fit([Hypothesis(LEG, free)], data, 1)
    assert begun is not None
    damping = refined_on_grid(begun, data).hypothesis.free[0]
    assert damping.values["damping"] == pytest.approx(0.3, rel=0.02)


def test_what_has_no_gap_is_left_alone() -> None:
    training, held_out = recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3}))
    data, _ = gather(LEG, training, held_out, seed=0)
    friction = applied(LEG, EffectKey("viscous_damping", "knee"), damping=0.28)
    (found,) = fit([Hypothesis(LEG, (friction,))], data, 1)
    assert found is not None and refined_on_grid(found, data) is found
