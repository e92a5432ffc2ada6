"""The leg on its plate: statics, Coulomb's limit, nothing in the air."""

import numpy as np
import pytest

from workbench.core import InputError
from workbench.rigs import (
    PERFECT,
    Experiment,
    HiddenEffect,
    Plate,
    VirtualLeg,
    leg_structure,
    plate_experiments,
)
from workbench.rigs.standing_leg import SHANK, THIGH, reach

QUIET = Plate(noise=0.0)


def foot(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Place of the foot's centre (N,) each, forward and up."""
    q1, q2 = position.T
    return THIGH * np.sin(q1) + SHANK * np.sin(q2), -THIGH * np.cos(q1) - SHANK * np.cos(q2)


def recorded(name: str, *hidden: HiddenEffect, duration: float = 1.0):
    chosen = next(e for e in plate_experiments(duration=duration) if e.name == name)
    return VirtualLeg(hidden, sensors=PERFECT, plate=QUIET).run([chosen])[0]


def test_at_rest_the_plate_carries_what_the_motors_press() -> None:
    start = plate_experiments(duration=0.01)[0]
    below = np.tile(reach(0.0, QUIET.height + QUIET.radius - 0.01), (1500, 1))
    held = Experiment("held", below, np.zeros_like(below), start.excitation)
    # the run starts where its reference does: 1 cm in the plate, which throws it out first
    r = VirtualLeg(sensors=PERFECT, plate=QUIET).run([held])[0]
    force, (q1, q2) = r.extra["ground_force"][-1], r.position[-1]
    torque = r.signals["torque_measured"][-1]
    jacobian = np.array([
        [THIGH * np.cos(q1), SHANK * np.cos(q2) + QUIET.radius], [THIGH * np.sin(q1), SHANK * np.sin(q2)],
    ])  # fmt: skip
    assert np.abs(r.velocity[-1]).max() < 1e-3
    assert force[2] > 10.0
    weight = leg_structure().reduced_dynamics(r.position[-1], np.zeros(2)).gravity
    # but for the force's own depth, half of which the plate takes
    np.testing.assert_allclose(torque + jacobian.T @ force[[0, 2]], -weight, atol=0.02)


def test_force_is_stiffness_times_depth_and_never_pulls() -> None:
    r = recorded("press")
    depth = QUIET.height + QUIET.radius - foot(r.position)[1]
    force = r.extra["ground_force"]
    slow = np.abs(np.gradient(depth, r.period)) < 0.01
    np.testing.assert_allclose(force[slow, 2], QUIET.stiffness * depth[slow], atol=1.6)
    step = recorded("step")
    assert step.extra["ground_force"][:, 2].min() >= 0.0
    away = foot(step.position)[1] > QUIET.height + QUIET.radius
    assert 0.1 < away.mean() < 0.9 and not step.extra["ground_force"][away].any()


@pytest.mark.parametrize("coefficient", [0.3, 0.6])
def test_friction_reaches_its_limit_where_the_foot_slips(
    coefficient: float,
) -> None:
    r = recorded("slide", HiddenEffect("ground_friction", parameters={"coefficient": coefficient}))
    force = r.extra["ground_force"]
    pressed = force[:, 2] > 5.0
    ratio = np.abs(force[pressed, 0]) / force[pressed, 2]
    assert ratio.max() <= coefficient + 1e-9
    q1, q2 = r.position.T
    speed = np.abs(
        THIGH * np.cos(q1) * r.velocity[:, 0] + (SHANK * np.cos(q2) + QUIET.radius) * r.velocity[:, 1]
    )
    slips = speed[pressed] > 0.05
    assert slips.sum() > 50
    np.testing.assert_allclose(ratio[slips], coefficient, rtol=1e-6)


def test_a_leg_in_the_air_hides_nothing_of_a_plate() -> None:
    with pytest.raises(InputError, match="stands on no ground"):
        VirtualLeg([HiddenEffect("ground_friction", parameters={"coefficient": 0.3})])
