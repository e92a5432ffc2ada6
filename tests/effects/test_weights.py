"""Weight without inertia acts whatever its sign, and whether or not anything else is compensated."""

import numpy as np
import pytest

from workbench.core import EffectKey, Estimate, SimulationError
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


def test_less_than_was_identified_is_taken_from_the_linkage() -> None:
    """What was identified too large may be so by more than the bare shank has."""
    tree = read_model("leg_kin_only")
    stated, less, right = (inertia(m22) for m22 in (0.0072, -0.002, 0.0052))
    q, v = np.array([[0.4, 0.9], [-0.7, 1.4]]), np.zeros((2, 2))
    both = reduced(compile_plant(tree.with_effect(stated).with_effect(less)), q, v)
    once = reduced(compile_plant(tree.with_effect(right)), q, v)
    np.testing.assert_allclose(both.mass, once.mass, rtol=1e-9)
    with pytest.raises(SimulationError, match="no body has such an inertia"):
        compile_plant(tree.with_effect(less))


def inertia(m22: float) -> AppliedEffect:
    """Of a linkage that has only this."""
    values = {"M11": 0.0, "M12": 0.0, "M22": m22}
    key = EffectKey("linkage_inertia", None)
    return AppliedEffect(key, {name: Estimate(x, 0, "kg*m^2") for name, x in values.items()})
