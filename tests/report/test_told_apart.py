"""What recordings cannot tell apart, in few sentences."""

from __future__ import annotations

from workbench.core import EffectKey, Identifiability
from workbench.report.told_apart import told_apart


def test_places_of_one_axis_are_told_together() -> None:
    pairs = tuple(
        (EffectKey(effect, axis), EffectKey(effect, axis, "joint"))
        for effect, axes in (
            ("viscous_damping", ("lift", "bend")),
            ("coulomb_friction", ("lift", "bend")),
            ("quadratic_drag", ("bend",)),
        )
        for axis in axes
    )
    others = (EffectKey("reflected_inertia", "bend"), EffectKey("link_inertia_error", "bend"))
    _, apart, both, one = told_apart(Identifiability((), (*pairs, others), (), ()))
    assert apart == (
        "They cannot tell apart: reflected inertia on the bend drive and link inertia error of the bend link."
    )
    assert both == (
        "They cannot tell the drive from the joint of lift and bend as the place of viscous damping or "
        "Coulomb friction."
    )
    assert one == "They cannot tell the drive from the joint of bend as the place of quadratic drag."
