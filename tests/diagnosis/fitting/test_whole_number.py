"""Right simulations differ by a share of a whole number, so that a change much smaller than it is no news."""

from __future__ import annotations

import numpy as np

from tests.diagnosis.rig import applied, asked, recordings
from workbench.core import EffectKey
from workbench.diagnosis.fitting.uncertainty import with_deviations
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.diagnosis.policy import POLICY
from workbench.diagnosis.significance import is_significant
from workbench.effects import load_model
from workbench.rigs import HiddenEffect


def test_a_rotor_off_by_less_than_a_thousandth_is_the_same() -> None:
    leg = load_model("leg")
    data = asked(leg, *recordings(HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.4}))).data
    own = leg.actuators.inertia[0]
    for share, another in ((0.001, False), (0.1, True)):
        rotor = applied(leg, EffectKey("reflected_inertia", "hip"), inertia=share * own)
        (known,) = with_deviations(Hypothesis(leg, (rotor,)), np.zeros((1, 1)), data).free
        assert known.parameters["inertia"].std >= POLICY.model_deviation * own
        assert is_significant(known) is another
