"""Dry friction that a file states is dry friction like any other: in the loop and along the motion."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tests.data_helpers import write_toml
from tests.dry_arm import LOSS, RIGID, dry_arm, made
from tests.simulation.make import having, leg_experiment, simulated
from workbench.core import EffectKey, InputError
from workbench.core.paths import models_folder
from workbench.effects import compile_plant, load_model
from workbench.models import Model, own_friction
from workbench.simulation import Track, required_torque, smooth_track

FRICTION = "coulomb_friction"


def added(folder: Path) -> Model:
    """The arm without friction in its file, and the same friction added."""
    model = load_model(dry_arm(folder, "none", name="plain"))
    for axis, loss in LOSS.items():
        model = having(model, EffectKey(FRICTION, axis), torque=loss)
    return model


def track_of(seconds: float = 3.0) -> Track:
    """A known motion of two axes."""
    t = np.arange(0.0, seconds, 0.002)[:, None]
    rate, size = 2 * np.pi * np.array([0.7, 1.1]), np.array([0.4, 0.05])
    return Track(size * np.sin(rate * t), size * rate * np.cos(rate * t), -size * rate**2 * np.sin(rate * t))


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicit", "implicitfast"])
def test_at_joints_it_is_the_effect(tmp_path: Path, integrator: str) -> None:
    asked, own = (
        made(dry_arm(tmp_path, "joint", RIGID), 1.0),
        load_model(dry_arm(tmp_path, integrator=integrator)),
    )
    one, other = simulated(own, asked), simulated(added(tmp_path), asked)
    np.testing.assert_array_equal(one.position, other.position)
    needed, like = (required_torque(compile_plant(m), track_of()) for m in (own, added(tmp_path)))
    np.testing.assert_array_equal(needed, like)


def test_on_tendons_it_is_the_same(tmp_path: Path) -> None:
    asked, own = made(dry_arm(tmp_path, "joint", RIGID), 1.0), load_model(dry_arm(tmp_path, "fixed"))
    one, other = simulated(own, asked), simulated(added(tmp_path), asked)
    np.testing.assert_allclose(one.position, other.position, atol=1e-9)
    needed, like = (required_torque(compile_plant(m), track_of()) for m in (own, added(tmp_path)))
    np.testing.assert_allclose(needed, like)


@pytest.mark.parametrize("step", [1e-4, 5e-4])
def test_the_needed_torque_has_it(tmp_path: Path, step: float) -> None:
    """Along a measured motion the models with and without it differ by its size, to a per cent."""
    stiff = RIGID.replace("0.0002", f"{2 * step:g}")
    log = made(dry_arm(tmp_path, "joint", stiff, name="machine"), step=step)
    noise = np.array([1e-4, 1e-5]), np.array([5e-3, 5e-4])
    track = smooth_track(log, None, np.eye(2), *noise)
    bare = required_torque(compile_plant(load_model(dry_arm(tmp_path, "none"))), track)
    own = required_torque(compile_plant(load_model(dry_arm(tmp_path))), track)
    moving = np.abs(track.velocity) > 0.3 * track.velocity.std(axis=0)
    held = log.signals["torque_measured"]  # from its row to the next: about a row acts the mean of two
    lacking = 0.5 * (held + np.vstack([held[:1], held[:-1]])) - bare
    for axis, loss in enumerate(LOSS.values()):
        side = np.sign(track.velocity[moving[:, axis], axis])
        assert np.mean(side * (own - bare)[moving[:, axis], axis]) == pytest.approx(loss, rel=1e-3)
        assert np.mean(side * lacking[moving[:, axis], axis]) == pytest.approx(loss, rel=0.01)


def test_where_several_drives_turn_a_joint_it_is_the_joints_own(tmp_path: Path) -> None:
    text = (models_folder() / "serial" / "leg.xml").read_text()
    (tmp_path / "dry.xml").write_text(re.sub(r'(<joint name="(hip|knee)")', r'\1 frictionloss="0.2"', text))
    table = {"format": 1, "name": "dry", "serial": "dry.xml", "axes": ["hip", "knee"]}
    table["transmission"] = {"joints": ["hip", "knee"], "matrix": [[1.0, 0.0], [1.0, 1.0]]}
    table["actuators"] = {"inertia": 0.0162, "damping": 0.0972}
    own = load_model(write_toml(tmp_path / "dry.toml", table))
    assert [str(e.key) for e in own_friction(own)] == [f"{FRICTION}@hip(joint)", f"{FRICTION}@knee(joint)"]
    other = load_model(write_toml(tmp_path / "plain.toml", table | {"serial": "serial/leg.xml"}))
    for axis in other.axes:
        other = having(other, EffectKey(FRICTION, axis, "joint"), torque=0.2)
    one, two = (simulated(m, leg_experiment(0.6)) for m in (own, other))
    np.testing.assert_array_equal(one.position, two.position)


def test_behind_a_gear_it_is_less_at_the_drive(tmp_path: Path) -> None:
    table = {"format": 1, "name": "geared", "serial": dry_arm(tmp_path).name, "axes": ["m1", "m2"]}
    table["transmission"] = {"joints": ["lift", "reach"], "matrix": [[-10.0, 0.0], [0.0, 50.0]]}
    found = own_friction(load_model(write_toml(tmp_path / "geared.toml", table)))
    assert [str(e.key) for e in found] == [f"{FRICTION}@m1", f"{FRICTION}@m2"]
    assert [e.values["torque"] for e in found] == pytest.approx([0.06, 0.08])


def test_a_soft_drive_has_it_on_its_motors_side(tmp_path: Path) -> None:
    place, soft = EffectKey("joint_compliance", "lift"), {"stiffness": 400.0, "damping": 0.5}
    own = having(load_model(dry_arm(tmp_path)), place, **soft)
    asked = made(dry_arm(tmp_path, "joint", RIGID), 0.6)
    one, other = (simulated(m, asked) for m in (own, having(added(tmp_path), place, **soft)))
    np.testing.assert_array_equal(one.position, other.position)


def test_a_tendon_through_space_has_it_by_its_arm(tmp_path: Path) -> None:
    rope = '<spatial name="rope" frictionloss="3"><site site="post"/><site site="tip"/></spatial>'
    file = dry_arm(tmp_path, "none")
    file.write_text(file.read_text().replace("<tendon>", f"<tendon>{rope}"))
    plain, track = dry_arm(tmp_path, "none", name="plain"), track_of()
    with_rope, without = (required_torque(compile_plant(load_model(f)), track) for f in (file, plain))
    reach, angle = 0.3 + track.position[:, 1], track.position[:, 0]
    tip = np.stack([reach * np.cos(angle) + 0.1, reach * np.sin(angle) - 0.3], axis=1)
    length = np.hypot(*tip.T)
    slopes = np.stack(
        [
            (-tip[:, 0] * reach * np.sin(angle) + tip[:, 1] * reach * np.cos(angle)) / length,
            (tip[:, 0] * np.cos(angle) + tip[:, 1] * np.sin(angle)) / length,
        ],
        axis=1,
    )
    rate = np.sum(slopes * track.velocity, axis=1)
    clear = np.abs(rate) > 0.1 * rate.std()
    wanted = 3.0 * np.sign(rate)[:, None] * slopes
    np.testing.assert_allclose((with_rope - without)[clear], wanted[clear], atol=1e-3)


def test_what_a_file_switches_off_stays_off(tmp_path: Path) -> None:
    """And an effect acts all the same."""
    file = dry_arm(tmp_path)
    file.write_text(
        file.read_text().replace(
            "<worldbody>", '<option><flag frictionloss="disable"/></option><worldbody>', 1
        )
    )
    model, plain = load_model(file), load_model(dry_arm(tmp_path, "none", name="plain"))
    assert own_friction(model) == ()
    asked = made(dry_arm(tmp_path, "joint", RIGID, name="machine"), 0.6)
    np.testing.assert_array_equal(simulated(model, asked).position, simulated(plain, asked).position)
    both = [having(m, EffectKey(FRICTION, "lift"), torque=0.5) for m in (model, plain)]
    one, other = (simulated(m, asked) for m in both)
    np.testing.assert_array_equal(one.position, other.position)
    assert np.abs(one.position - simulated(plain, asked).position).max() > 1e-3


def test_less_than_stated_may_be_added_and_not_less_than_none(tmp_path: Path) -> None:
    own, plain = load_model(dry_arm(tmp_path)), load_model(dry_arm(tmp_path, "none", name="plain"))
    none = own
    for axis, loss in LOSS.items():
        none = having(none, EffectKey(FRICTION, axis), torque=-loss)
        with pytest.raises(InputError, match="lies outside"):
            having(own, EffectKey(FRICTION, axis), torque=-loss - 0.1)
    with pytest.raises(InputError, match="lies outside"):
        having(none, EffectKey(FRICTION, "lift"), torque=-0.1)
    asked = made(dry_arm(tmp_path, "joint", RIGID, name="machine"), 0.6)
    np.testing.assert_array_equal(simulated(none, asked).position, simulated(plain, asked).position)
