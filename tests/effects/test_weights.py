"""Weight without inertia acts whatever its sign, and whether or not anything else is compensated."""

import numpy as np
import pytest

from workbench.core import EffectKey, Estimate
from workbench.effects import compile_plant
from workbench.models import AppliedEffect, read_model
from workbench.s3n import reduced


@pytest.mark.parametrize(("g1", "g2"), [(0.5, 0.1), (-0.5, 0.1), (0.3, -0.2), (-0.3, -0.2)])
def test_linkage_gravity_alone(g1: float, g2: float) -> None:
    model = read_model("leg_kin_only")
    key = EffectKey("linkage_gravity", None)
    heavy = model.with_effect(
        AppliedEffect(key, {"g1": Estimate(g1, 0, "N*m"), "g2": Estimate(g2, 0, "N*m")})
    )
    q, v = np.array([[0.4, 0.9], [-0.7, 1.4]]), np.zeros((2, 2))
    added = reduced(compile_plant(heavy), q, v).gravity - reduced(compile_plant(model), q, v).gravity
    wanted = -np.array([g1, g2]) * np.sin(q @ model.transmission.T) @ model.transmission
    np.testing.assert_allclose(added, wanted, atol=1e-9)
