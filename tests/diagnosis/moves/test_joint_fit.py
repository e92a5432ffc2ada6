"""What is certain has its true size although something larger, which no effect explains, is on its axis."""

from __future__ import annotations

import numpy as np
import pytest

from tests.diagnosis.moves.test_joint_solution import recorded
from tests.diagnosis.moves.test_shared_effects import gantry
from workbench.core import EffectKey, Estimate
from workbench.diagnosis import diagnose
from workbench.diagnosis.adequacy.free_functions import Adequacy
from workbench.diagnosis.data import gather
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.diagnosis.moves.joint_fit import certain_only
from workbench.diagnosis.problem import evaluated
from workbench.models import AppliedEffect


def test_friction_beside_a_hum_takes_little_of_the_damping() -> None:
    runs = recorded((1.5, 0.8, 0.4), [2.0, 1.5, 1.0], np.array([0.0, 1.5, 0.0]), loop=False)
    told = diagnose(gantry(3), runs[:2], runs[2:])
    assert told.verdict == "partly_explained"
    found = {str(f.key): f.parameters for f in told.findings}
    assert found["coulomb_friction@y"]["torque"].value == pytest.approx(0.8, rel=0.1)
    assert {k.split("@")[0] for k in found} == {"coulomb_friction", "viscous_damping"}


@pytest.mark.parametrize(("deviations", "named"), [(2.5, {"x"}), (3.5, {"x", "y"})])
def test_what_is_certain_has_to_be_clear_of_nothing_too(deviations: float, named: set[str]) -> None:
    """A law that is adequate may still have no size: one bar of three deviations holds for every name."""
    model = gantry(2)
    data, runs = gather(model, recorded((0.0, 0.0), [2.0, 1.5], np.zeros(2), loop=False), (), seed=0)
    sizes = {"x": (2.0, 0.01), "y": (1.0, 1.0 / deviations)}
    free = tuple(
        AppliedEffect(EffectKey("viscous_damping", axis), {"damping": Estimate(value, std, "N*s/m")})
        for axis, (value, std) in sizes.items()
    )
    whole = evaluated(Hypothesis(model, free), runs.clean, data)
    found = certain_only(whole, {a.key: Adequacy(1.0, 1.0, 0.0) for a in free}, data)
    assert found is not None and {a.key.axis for a in found.hypothesis.free} == named
