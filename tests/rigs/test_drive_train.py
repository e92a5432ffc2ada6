"""Drives of a robot move as the rig's own leg says that they do, and refuse what they cannot follow."""

import numpy as np
import pytest

from workbench.core import InputError
from workbench.rigs import DriveSide, DriveTrain, HiddenEffect, drive_side

STEP = 0.5e-3
PLAY = DriveSide(gap=0.004, stiffness=400.0)


def test_a_perfect_drive_passes_its_torque_on() -> None:
    train = DriveTrain([DriveSide()] * 2, STEP)
    torque, q, v = np.array([1.0, -2.0]), np.array([0.3, 0.1]), np.array([1.0, -5.0])
    np.testing.assert_array_equal(train.advance(torque, q, v), torque)
    np.testing.assert_array_equal(train.rotor, [0.0162, 0.0162])
    np.testing.assert_array_equal(train.motion(q, v), [q, v])


def test_a_wrong_torque_constant_and_opposing_friction() -> None:
    train = DriveTrain([DriveSide(gain=0.9, friction=0.3)] * 3, STEP)
    passed = train.advance(np.array([1.0, 1.0, 0.0]), np.zeros(3), np.array([2.0, -2.0, 0.0]))
    np.testing.assert_allclose(passed, [0.6, 1.2, 0.0])


def test_play_is_torqueless_and_its_flanks_conserve_energy() -> None:
    """A rotor between the flanks of a link that is held: it bounces, and only its damping takes energy."""
    side = DriveSide(damping=0.0, gap=PLAY.gap, stiffness=PLAY.stiffness)
    train = DriveTrain([side], STEP)
    train.reset(np.zeros(1))
    still = np.zeros(1)
    passed = [train.advance(np.full(1, 1.0 if k < 10 else 0.0), still, still)[0] for k in range(4000)]
    assert passed[0] == passed[1] == 0.0 and min(passed) < -0.5 and max(passed) > 0.5
    speeds = []
    for _ in range(4000):
        train.advance(still, still, still)
        speeds.append(abs(train.motion(still, still)[1][0]))
    assert max(speeds[2000:]) == pytest.approx(max(speeds[:2000]), rel=0.02)


def test_a_link_pushed_through_play_settles_at_the_flank() -> None:
    train = DriveTrain([PLAY], STEP)
    train.reset(np.zeros(1))
    still = np.zeros(1)
    for _ in range(8000):
        passed = train.advance(np.full(1, 2.0), still, still)
    assert passed[0] == pytest.approx(2.0, rel=1e-3)
    assert train.motion(still, still)[0][0] == pytest.approx(0.5 * PLAY.gap + 2.0 / PLAY.stiffness, rel=1e-3)
    assert train.rotor[0] == 0.0  # it turns here, not with the link


def test_flanks_that_a_step_cannot_follow_are_refused() -> None:
    with pytest.raises(InputError, match="too stiff"):
        DriveTrain([DriveSide(gap=0.001, stiffness=1e5)], STEP)


def test_a_drive_has_its_own_effects_only() -> None:
    hidden = (
        HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.05}),
        HiddenEffect("backlash", "knee", parameters={"gap": 0.004, "stiffness": 400.0}),
        HiddenEffect("coulomb_friction", "hip", parameters={"torque": 0.2}),
        HiddenEffect("link_length_error", "hip", parameters={"length": 0.01}),
    )
    knee = drive_side(hidden, "knee")
    assert knee.damping == pytest.approx(0.1472) and knee.gap == 0.004 and knee.friction == 0.0
    damped = {"gap": 0.004, "stiffness": 400.0, "damping": 0.5}
    with pytest.raises(InputError, match="elastic"):
        drive_side([HiddenEffect("backlash", "knee", parameters=damped)], "knee")
    assert not knee.rigid and drive_side(hidden, "hip") == DriveSide(friction=0.2)
