"""A mechanism whose transmission changes, seen from its drives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.simulation.make import hold_slopes_to_differences
from workbench.core import EffectKey, Estimate, SimulationError
from workbench.effects import compile_plant, places
from workbench.models import AppliedEffect, read_model
from workbench.s3n import PostureDependent, drive_map, off_drives, on_drives
from workbench.simulation import PosturePlant, Track, required_torque, slopes


def _states(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Joint positions well inside the limits, and rates."""
    box, generator = PostureDependent(read_model("four_bar")).box, np.random.default_rng(seed)
    inside = box.mean(axis=1) + 0.3 * np.ptp(box, axis=1) * generator.uniform(-1.0, 1.0, (count, len(box)))
    return inside, generator.normal(size=(count, len(box)))


@pytest.mark.parametrize(
    "seed, effects", [(0, {}), (1, {"reflected_inertia": "inertia", "viscous_damping": "damping"})]
)
def test_the_torque_that_drives_need_is_the_one_that_moved_them(seed: int, effects: dict[str, str]) -> None:
    model = read_model("four_bar")
    for name, number in effects.items():
        key = EffectKey(name, model.axes[1])
        model = model.with_effect(AppliedEffect(key, {number: Estimate(0.02, 0.0, "")}))
    plant, own = PosturePlant(model), drive_map(model)
    assert own is not None
    q, v = _states(40, seed)
    torque = np.random.default_rng(seed + 10).normal(size=q.shape)
    a = plant.acceleration(q, v, torque)
    step = 1e-6  # the drives' motion, by differences of where they are
    drives = [own.drives(q + t * v + 0.5 * t**2 * a) for t in (-step, 0.0, step)]
    rate = np.einsum("kij,kj->ki", own.jacobian(q), v)
    turned = [np.einsum("kij,kj->ki", own.jacobian(q + t * v), v + t * a) for t in (-step, step)]
    track = Track(drives[1], rate, (turned[1] - turned[0]) / (2.0 * step))
    found = required_torque(compile_plant(on_drives(model)), track)
    np.testing.assert_allclose(found, torque, atol=2e-5 * np.abs(torque).max())


def test_slopes_are_those_of_the_torque() -> None:
    model = on_drives(read_model("four_bar"))
    q, v = _states(6, 3)
    own = drive_map(read_model("four_bar"))
    assert own is not None
    track = Track(own.drives(q), v, np.random.default_rng(4).normal(size=q.shape))
    plant = compile_plant(model)
    assert list(slopes(plant, track, 0.01)[0]) == list(range(6))
    hold_slopes_to_differences(plant, track)


def test_drives_where_no_link_can_follow_are_refused() -> None:
    carried = on_drives(read_model("four_bar")).carried
    assert carried is not None
    still = np.zeros((1, 2))
    with pytest.raises(SimulationError, match="outside its workspace"):
        carried.at(np.array([[0.0, 40.0]]), still, still)


def test_effects_at_drives_and_links_go_back_into_the_model() -> None:
    given = read_model("four_bar")
    there = on_drives(given)
    offered = {key.effect for key in places(there)}
    assert {"coulomb_friction", "torque_constant_error", "cogging", "encoder_offset"} <= offered
    assert {"payload_mass", "first_moment_error", "link_inertia_error"} <= offered
    assert not offered & {"link_length_error", "backlash", "base_compliance", "actuator_inertia_coupling"}
    assert {key.location for key in places(there)} == {"actuator"}
    back = off_drives(replace(there, name="better"), given)
    assert (back.name, back.serial, back.joints, back.carried) == ("better", given.serial, given.joints, None)
    np.testing.assert_array_equal(back.transmission, given.transmission)
    constant = read_model("leg")
    assert on_drives(constant) is constant
