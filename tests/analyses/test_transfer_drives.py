"""Drives of the study's robots move as the rig's own leg says, and refuse what they cannot follow."""

import numpy as np
import pytest
from transfer_drives import DriveSide, DriveTrain, UsedDriveBench, drive_side

from workbench.core import Excitation, InputError
from workbench.rigs import PERFECT, HiddenEffect

STEP = 0.5e-3
NOISE = Excitation("multisine")
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


HIDDEN = (
    HiddenEffect("torque_constant_error", "hip", parameters={"gain": 0.9}),
    HiddenEffect("reflected_inertia", "hip", parameters={"inertia": 0.004}),
    HiddenEffect("coulomb_friction", "hip", parameters={"torque": 0.3}),
    HiddenEffect("coulomb_friction", "knee", "joint", {"torque": 9.0}),
    HiddenEffect("payload_mass", None, parameters={"mass": 9.0}),
)


def test_the_drive_hides_on_the_bench_what_it_hides_in_the_leg() -> None:
    t = 1e-3 * np.arange(600)
    log = UsedDriveBench(HIDDEN, sensors=PERFECT).run({"a": 2.0 * np.sin(20.0 * t)}, NOISE)[0]
    torque, w = (log.signals[k][:, 0] for k in ("torque_measured", "velocity"))
    acceleration = np.gradient(w, 1e-3)
    moving = (np.abs(w) > 0.2)[1:-1] & (np.abs(np.diff(torque, 2)) < 1e-12)  # amid a command that is held
    left = 0.0202 * acceleration + 0.0972 * w + 0.3 * np.sign(w) - 0.9 * torque
    assert moving.sum() > 100 and np.abs(left[1:-1][moving]).max() < 2e-3
    nominal, knee = (
        UsedDriveBench(hidden, "knee", sensors=PERFECT).run({"a": t}, NOISE)[0] for hidden in ((), HIDDEN)
    )
    np.testing.assert_array_equal(nominal.position, knee.position)


def test_it_sticks_below_its_friction_and_comes_to_rest() -> None:
    weak = UsedDriveBench(HIDDEN, sensors=PERFECT).run({"a": np.full(300, 0.32)}, NOISE)[0]
    assert not weak.position.any()  # 0.9 of it is less than 0.3
    push = np.where(np.arange(900) < 100, 1.0, 0.0)
    log = UsedDriveBench(HIDDEN, sensors=PERFECT).run({"a": push}, NOISE)[0]
    assert log.position[-1, 0] > 0.05 and not log.signals["velocity"][-200:].any()


def test_what_a_drive_by_itself_cannot_hide_is_refused() -> None:
    with pytest.raises(InputError, match="cogging"):
        UsedDriveBench((HiddenEffect("cogging", "hip"),))
