"""The textbook method that the diagnosis is held against is a good one: it finds what it can find."""

import pytest
from baselines.inverse_dynamics import candidates, motion_of, needed
from baselines.least_squares import least_squares

from workbench.core import Recording
from workbench.rigs import HiddenEffect, VirtualLeg, chirp, slow_sweep


def recordings(*hidden: HiddenEffect) -> list[Recording]:
    experiments = [chirp("hip"), chirp("knee"), slow_sweep(8.0)]
    return VirtualLeg(hidden, seed=4).run(experiments)


def test_the_nominal_leg_leaves_hardly_any_torque_and_no_name() -> None:
    clean = recordings()
    motion = motion_of(clean)
    left = motion.smooth(motion.u - needed(motion.q, motion.w, motion.a))
    assert left.std(axis=0).max() < 0.02
    assert least_squares(clean).verdict == "consistent"


@pytest.mark.parametrize(
    ("hidden", "name", "tolerance"),
    [
        (HiddenEffect("reflected_inertia", "hip", parameters={"inertia": 0.008}), "inertia", 0.01),
        (HiddenEffect("torque_constant_error", "knee", parameters={"gain": 0.85}), "gain", 0.002),
        (HiddenEffect("viscous_damping", "knee", "joint", {"damping": 0.2}), "damping", 0.01),
        (HiddenEffect("payload_mass", parameters={"mass": 0.1}), "mass", 0.02),
        (
            HiddenEffect("parallel_spring", "hip", parameters={"stiffness": 2.0, "rest": -0.3}),
            "stiffness",
            0.03,
        ),
    ],
)
def test_a_linear_effect_is_named_first_with_its_size(
    hidden: HiddenEffect, name: str, tolerance: float
) -> None:
    first = least_squares(recordings(hidden)).named[0]
    assert (first.key.effect, first.key.axis, first.key.location) == (
        hidden.effect,
        hidden.axis,
        hidden.location,
    )
    assert first.parameters[name].value == pytest.approx(hidden.parameters[name], rel=tolerance)


def test_aic_takes_at_least_as_many_effects_as_bic() -> None:
    data = recordings(HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.3}))
    assert len(least_squares(data, "aic").named) >= len(least_squares(data, "bic").named)


def test_every_candidate_reads_back_its_own_factors() -> None:
    motion = motion_of(recordings()[:1])
    for candidate in candidates(motion):
        factors = 1.0 + 0.1 * candidate.columns.shape[0] * motion.q[: len(candidate.columns), 0]
        read = candidate.reading(factors)
        for name, (value, slope) in read.items():
            step = 1e-6
            for i in range(len(factors)):
                moved = factors.copy()
                moved[i] += step
                assert (candidate.reading(moved)[name][0] - value) / step == pytest.approx(slope[i], abs=1e-4)
