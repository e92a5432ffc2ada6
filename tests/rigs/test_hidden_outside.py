"""What no catalogue explains does what its equation says, seen from outside: in the logs."""

import numpy as np
import pytest

from tests.rigs.test_hidden import log, lost_torque, needed_torque, still, wave
from workbench.rigs import HiddenEffect, VirtualLeg
from workbench.rigs.drive import Drive
from workbench.rigs.experiments import HOLD
from workbench.rigs.hidden import install
from workbench.rigs.machine import Machine

FULL = {  # every parameter of every one, at one size
    "rough_patch": ("knee", "joint", {"torque": 0.4, "angle": 1.05, "width": 0.05}),
    "one_sided_spring": ("hip", "actuator", {"stiffness": 6.0, "rest": -0.55}),
    "cross_spring": (None, "actuator", {"stiffness": 0.8, "rest": 0.2}),
    "cross_damping": ("knee", "actuator", {"damping": 0.1}),
    "drifting_torque": ("hip", "actuator", {"torque": 0.3, "time": 0.5}),
    "torque_hysteresis": ("knee", "actuator", {"torque": 0.3}),
    "torque_deadband": ("hip", "actuator", {"torque": 0.3}),
    "torque_dropout": ("hip", "actuator", {"interval": 0.2, "duration": 0.02}),
}


def hidden(name: str) -> HiddenEffect:
    axis, location, parameters = FULL[name]
    return HiddenEffect(name, axis, location, parameters)


def test_friction_is_where_the_patch_is() -> None:
    recording = log([hidden("rough_patch")], wave())
    q, v = (0.5 * (x[1:] + x[:-1]) for x in (recording.position, recording.velocity))
    lost = recording.signals["torque_measured"][:-1] - needed_torque(recording)
    angle, slip = q[:, 1] - q[:, 0], v[:, 1] - v[:, 0]
    expected = 0.4 * np.exp(-(((angle - 1.05) / 0.05) ** 2)) * np.sign(slip)
    moving = np.abs(slip) > 0.2
    np.testing.assert_allclose(lost[moving] @ [-0.5, 0.5], expected[moving], atol=3e-3)
    assert np.abs(expected[moving]).max() > 0.3 > 0.05 > np.abs(expected[moving]).min()


def test_a_strap_pulls_one_way_only() -> None:
    lost, _ = lost_torque(hidden("one_sided_spring"), wave())
    position = log([hidden("one_sided_spring")], wave()).position[:, 0]
    q = 0.5 * (position[1:] + position[:-1])
    np.testing.assert_allclose(lost[:, 0], 6.0 * np.maximum(q + 0.55, 0.0), atol=3e-3)
    assert q.min() < -0.6 and q.max() > -0.5


def test_a_spring_between_motors_winds_by_their_sum() -> None:
    recording = log([hidden("cross_spring")], still())
    q, u = recording.position[-1], recording.signals["torque_measured"][-1]
    gravity = np.array([1.850411 * np.sin(q[0]), 0.274007 * np.sin(q[1])])
    np.testing.assert_allclose(u - gravity, 0.8 * (q.sum() - 0.2) * np.ones(2), atol=2e-4)


@pytest.mark.parametrize(("axis", "own", "other"), [("hip", 0, 1), ("knee", 1, 0)])
def test_cross_damping_is_of_the_other_speed(axis: str, own: int, other: int) -> None:
    lost, speed = lost_torque(HiddenEffect("cross_damping", axis, parameters={"damping": 0.1}), wave())
    np.testing.assert_allclose(lost[:, own], 0.1 * speed[:, other], atol=2e-3)
    np.testing.assert_allclose(lost[:, other], 0.0, atol=1e-3)


def test_cross_damping_is_the_same_with_more_coordinates() -> None:
    """A spring that is stiff and a plain leg agree."""
    stiff = HiddenEffect("joint_compliance", "hip", parameters={"stiffness": 2e4, "damping": 20.0})
    plain, flexible = (log([hidden("cross_damping"), *more], wave(400)) for more in ([], [stiff]))
    without = log([], wave(400))
    apart = np.abs(plain.position - without.position).max()
    assert np.abs(flexible.position - plain.position).max() < 0.2 * apart


def test_a_drift_is_a_straight_line_of_its_own_in_each_run() -> None:
    runs = VirtualLeg([hidden("drifting_torque")], seed=3).run([still(1001), still(1001)])
    lines = []
    for recording in runs:
        lost = (recording.signals["torque_measured"][:-1] - needed_torque(recording))[:, 0]
        t = recording.time[:-1]
        lines.append(np.polyfit(t[20:], lost[20:], 1))
    assert abs(lines[0][1] - lines[1][1]) > 0.05
    walk = log([hidden("drifting_torque")], still(1001))
    lost = (walk.signals["torque_measured"][:-1] - needed_torque(walk))[:, 0]
    slope, level = np.polyfit(walk.time[:-1], lost, 1)
    np.testing.assert_allclose(lost, level + slope * walk.time[:-1], atol=2e-3)
    assert abs(slope) > 0.05


def applied(name: str, asked: np.ndarray) -> np.ndarray:
    """Torque that the rotor gets, row by row, of a command (N,)."""
    machine = Machine(delay=0.0)
    effect = hidden(name)
    install(effect, machine)
    drive, got = Drive(machine, 1e-3, np.random.default_rng(5)), []
    for torque in asked:
        both = [0.0, 0.0]
        both[effect.place.index] = float(torque)
        drive.command((both[0], both[1]))
        ((*torques, _),) = list(drive.advance([0.0, 0.0]))
        got.append(torques[effect.place.index])
    return np.array(got)


def test_play_keeps_its_distance_and_its_place() -> None:
    asked = np.concatenate([np.linspace(0, 2, 50), np.linspace(2, -2, 100), np.linspace(-2, 0, 50)])
    got = applied("torque_hysteresis", asked)
    assert np.abs(got - asked).max() == pytest.approx(0.3)
    assert np.all(got[49:56] == got[49])  # turned round, within the play
    assert got[asked.argmax()] == pytest.approx(1.7) and got[asked.argmin()] == pytest.approx(-1.7)


def test_a_deadband_swallows_small_torque() -> None:
    asked = np.linspace(-1, 1, 41)
    np.testing.assert_allclose(
        applied("torque_deadband", asked), np.sign(asked) * np.maximum(np.abs(asked) - 0.3, 0.0), atol=1e-12
    )


def test_a_loose_contact_opens_as_often_and_long_as_it_should() -> None:
    got = applied("torque_dropout", np.ones(40_000))
    assert set(got) == {0.0, 1.0}
    edges = np.flatnonzero(np.diff(got))
    lengths = np.diff(edges)[0 if got[edges[0]] == 1.0 else 1 :: 2]
    assert np.all(np.abs(lengths - 20) <= 1)
    assert len(lengths) == pytest.approx(40 / 0.22, rel=0.25)


def test_what_is_random_repeats_with_the_seed() -> None:
    effect = hidden("torque_dropout")
    first, again, other = (VirtualLeg([effect], seed).run([wave(800)])[0].position for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 1e-3


@pytest.mark.parametrize("name", FULL)
def test_none_of_it_shows_as_torque_alone(name: str) -> None:
    """Each changes the motion, and the leg starts where it was put."""
    recording, nominal = log([hidden(name)], wave(600)), log([], wave(600))
    assert np.abs(recording.position - nominal.position).max() > 2e-4
    np.testing.assert_allclose(recording.position[0], [HOLD[0], HOLD.sum()], atol=1e-12)
