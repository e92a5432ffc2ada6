"""What passes from a drive to the links, and what stays ahead of a gap."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.effects.cases import VALUES, reference
from tests.simulation.make import having
from workbench.core import EffectKey
from workbench.effects import Motion, Passage, compile_plant, load_model
from workbench.models import Model, Placement
from workbench.simulation import Track, motion_of

LEG = load_model("leg")
GAP = EffectKey("backlash", "knee")
AT_THE_DRIVE = (
    "coulomb_friction",
    "viscous_damping",
    "reflected_inertia",
    "torque_bias",
    "torque_constant_error",
)


def motion(model: Model) -> Motion:
    """The reference motion of the leg as a model sees it."""
    run = reference("leg")
    velocity = np.gradient(run.position, run.period, axis=0)
    track = Track(run.position, velocity, np.gradient(velocity, run.period, axis=0))
    return motion_of(track, run, compile_plant(model), np.eye(2))


def passage(model: Model) -> Passage:
    """What passes at the knee's drive."""
    place = Placement.of(model, GAP)
    assert place is not None
    return Passage.of(motion(model), model, place)


@pytest.mark.parametrize("effect", AT_THE_DRIVE)
def test_what_a_drive_has_does_not_load_the_gap_behind_it(effect: str) -> None:
    """It changes what passed of a motor's torque, and nothing of what the links need."""
    bare, more = passage(LEG), passage(having(LEG, EffectKey(effect, "knee"), **VALUES[effect]))
    size = np.abs(bare.load).max()
    np.testing.assert_allclose(more.load, bare.load, atol=1e-9 * size)
    assert np.abs(more.passed - bare.passed).max() > 0.01 * size


def test_what_the_links_have_loads_it_and_takes_nothing() -> None:
    bare = passage(LEG)
    more = passage(having(LEG, EffectKey("viscous_damping", "knee", "joint"), damping=0.3))
    size = np.abs(bare.load).max()
    np.testing.assert_allclose(more.passed, bare.passed, atol=1e-9 * size)
    assert np.abs(more.load - bare.load).max() > 0.01 * size


@pytest.mark.parametrize("location", ["actuator", "joint"])
def test_one_more_torque_is_what_an_effect_of_that_torque_does(location: str) -> None:
    key, damping = EffectKey("viscous_damping", "knee", location), 0.3
    place = Placement.of(LEG, key)
    assert place is not None
    _, speed, _ = motion(LEG).along(place)
    added = passage(LEG).with_torque(-damping * speed, at_motor=location == "actuator")
    built = passage(having(LEG, key, damping=damping))
    size = np.abs(built.load).max()
    np.testing.assert_allclose(added.load, built.load, atol=0.01 * size)
    np.testing.assert_allclose(added.passed, built.passed, atol=0.01 * size)


def test_a_gap_is_told_by_means_over_a_time_once_it_has_settled() -> None:
    """Whatever the rate of the log."""
    seen = passage(LEG)
    error = np.where(seen.known, seen.unforeseen(0.01, 0.005, 300.0, 0.0), 0.0)
    means = seen.unforeseen_means(0.01, 0.005, 300.0, 0.0)
    first, rows = round(0.2 / seen.step), round(0.016 / seen.step)
    assert means[20] == pytest.approx(error[first + 20 * rows : first + 21 * rows].mean())
    assert len(means) == (len(error) - first) // rows


def test_what_friction_holds_at_rest_says_nothing_of_a_gap() -> None:
    """Whatever the torque there."""
    seen = passage(having(LEG, EffectKey("coulomb_friction", "knee"), torque=0.3))
    rest = np.flatnonzero(~seen.known)[1:]  # the first says where it begins
    assert 0 < len(rest) < len(seen.known) // 2
    pushed = seen.passed.copy()
    pushed[rest] += 5.0
    other = replace(seen, passed=pushed)
    ours, theirs = (p.unforeseen_means(0.01, 0.005, 300.0, 0.0) for p in (seen, other))
    np.testing.assert_array_equal(ours, theirs)
