"""What is certain has its true size although something larger, which no effect explains, is on its axis."""

from __future__ import annotations

import numpy as np
import pytest

from tests.diagnosis.moves.test_joint_solution import recorded
from tests.diagnosis.moves.test_shared_effects import gantry
from workbench.diagnosis import diagnose


def test_friction_beside_a_large_hum_takes_up_little_of_the_damping_that_the_hum_hides() -> None:
    runs = recorded((1.5, 0.8, 0.4), [2.0, 1.5, 1.0], np.array([0.0, 1.5, 0.0]), loop=False)
    told = diagnose(gantry(3), runs[:2], runs[2:])
    assert told.verdict == "partly_explained"
    found = {str(f.key): f.parameters for f in told.findings}
    assert found["coulomb_friction@y"]["torque"].value == pytest.approx(0.8, rel=0.1)
    assert {k.split("@")[0] for k in found} == {"coulomb_friction", "viscous_damping"}
