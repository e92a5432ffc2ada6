"""The machine that trains is the one that was normalised, four times under a trunk."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from workbench.core import Controller, EffectKey, Estimate, InputError
from workbench.effects import load_model
from workbench.models import AppliedEffect, Model
from workbench.training.control import drive_torque
from workbench.training.environment import Environment
from workbench.training.machine import POLICY_STEPS, STEP_S, make_machine
from workbench.training.randomisation import Randomisation, world_fields
from workbench.training.situation import POLICY_S, Constants
from workbench.training.tasks import TASKS
from workbench.training.worlds import BatchWorlds

from .make import machine

# paper, mass matrix in serial coordinates at alpha = 90 degrees: M11, M12, M22
TABLE = {
    "kin_only": (0.04058, 0.00232, 0.01852),
    "s3n_act": (0.05678, 0.01852, 0.01852),
    "s3n_full": (0.07161, 0.02368, 0.02368),
}


@pytest.mark.parametrize("variant", TABLE)
def test_every_leg_has_the_paper_s_mass_matrix(variant: str) -> None:
    made = machine("quadruped", variant)
    m, data = made.mujoco, mujoco.MjData(made.mujoco)
    data.qpos[3] = 1.0
    data.qpos[made.places] = np.tile([0.0, 0.2, np.pi / 2], 4)
    mujoco.mj_forward(m, data)
    full = np.zeros((m.nv, m.nv))
    mujoco.mj_fullM(m, data, full)
    for leg in range(4):
        dofs = made.dofs[3 * leg + 1 : 3 * leg + 3]
        block = full[np.ix_(dofs, dofs)]
        np.testing.assert_allclose([block[0, 0], block[0, 1], block[1, 1]], TABLE[variant], atol=2e-5)


def test_timing_gains_and_limits_are_the_reference_s() -> None:
    made = machine("quadruped")
    assert (0.003, 6, pytest.approx(0.018)) == (STEP_S, POLICY_STEPS, POLICY_S)
    assert made.delay_steps == 1 and not made.mujoco.actuator_delay.any()
    assert set(made.kp) == {50.0} and set(made.kd) == {1.5} and set(made.torque_limit) == {24.0}
    assert made.mujoco.opt.timestep == 0.003


def test_only_the_reference_leg_has_its_hold_posture() -> None:
    leg = load_model("leg_kin_only")
    np.testing.assert_allclose(make_machine("leg", leg).posture, [-0.55, np.pi / 3])
    np.testing.assert_array_equal(make_machine("leg", replace(leg, closed_chain=None)).posture, 0.0)


def test_the_file_is_the_machine() -> None:
    made = machine("quadruped")
    again = mujoco.MjModel.from_xml_string(made.xml)
    np.testing.assert_array_equal(again.body_mass, made.mujoco.body_mass)
    np.testing.assert_array_equal(again.tendon_armature, made.mujoco.tendon_armature)


def test_the_loop_maps_to_the_drives_and_is_clipped_there() -> None:
    made = machine("leg")
    c = Constants(made, np, np.zeros(1))
    rest = made.posture[None]
    torque = drive_torque(c, rest + np.array([0.1, 0.2]), rest, np.zeros((1, 2)))
    np.testing.assert_allclose(made.transmission.T @ torque[0], [5.0, 10.0])  # tau_s = J^T tau_p
    assert np.abs(drive_torque(c, rest + 5.0, rest, np.zeros((1, 2)))).max() == 24.0


def test_an_effect_that_was_found_is_in_every_leg() -> None:
    found = AppliedEffect(EffectKey("coulomb_friction", "hip"), {"torque": Estimate(0.25, 0.01, "N*m")})
    made = make_machine("quadruped", load_model("leg").with_effect(found), "s3n_full")
    hips = [made.mujoco.joint(name).frictionloss[0] for name in made.joints if name.endswith("hip")]
    assert hips == [0.25] * 4 and made.left_out == ()


@pytest.mark.parametrize("location", ["actuator", "joint"])
def test_a_policy_sees_play_through_the_motor_s_encoder(location: str) -> None:
    values = {"gap": Estimate(0.004, 1e-4, "rad"), "stiffness": Estimate(400.0, 10.0, "N*m/rad")}
    play = AppliedEffect(EffectKey("backlash", "knee", location), values)
    made = make_machine("quadruped", load_model("leg").with_effect(play), "s3n_full")
    rotors = made.rotors
    assert len(rotors.places) == 4 and made.left_out == ()
    # with springs at rest, motors read what rigid ones would
    rest = rotors.drives @ np.vstack([np.eye(made.size), rotors.follow])
    np.testing.assert_allclose(rest, made.transmission, atol=1e-12)
    # across the gap the links move and the encoders do not
    task = TASKS["pitch-in-place"]
    engine = BatchWorlds(made, 2, world_fields(made, Randomisation(legs="none"), 2, 0), threads=1)
    worlds = Environment(task, made, engine, 2, Randomisation(legs="none"), 0, noise=False)
    before = worlds.situation().position.copy()
    engine.qpos[:, made.places[2]] += 0.001
    np.testing.assert_allclose(worlds.situation().position, before, atol=1e-12)
    engine.qpos[:, rotors.places[0]] += 0.001
    moved = worlds.situation().position - before
    np.testing.assert_allclose(moved @ made.transmission.T, np.eye(12)[[2, 2]] * 0.001, atol=1e-12)
    fell = [bool(np.any(worlds.step(np.zeros((2, 12))).ended)) for _ in range(20)]
    assert not any(fell)


def test_rigid_drives_read_the_transmission() -> None:
    for kind in ("leg", "quadruped"):
        made = machine(kind)
        np.testing.assert_allclose(made.rotors.drives, made.transmission, atol=1e-12)


def test_the_robot_stands_by_itself_on_four_feet() -> None:
    made = machine("quadruped")
    data = mujoco.MjData(made.mujoco)
    data.qpos[2], data.qpos[made.places] = made.height + 0.005, made.posture
    waiting = np.zeros(12)
    for _ in range(600):
        asked = made.kp * (made.posture - data.qpos[made.places]) - made.kd * data.qvel[made.dofs]
        data.ctrl[:], waiting = waiting, asked @ np.linalg.inv(made.transmission)
        mujoco.mj_step(made.mujoco, data)
    weight = 9.81 * float(made.mujoco.body_mass @ (1.0 - made.mujoco.body_gravcomp))
    loads = [data.sensor(f"{leg}_touch").data[0] for leg in ("fl", "fr", "rl", "rr")]
    assert sum(loads) == pytest.approx(weight, rel=0.05) and min(loads) > 10.0
    assert data.qpos[2] > 0.3


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"controller": Controller("none")}, "PD loop"),
        ({"payload_site": None}, "a foot"),
    ],
)
def test_models_that_cannot_train_are_refused(change: dict, says: str) -> None:
    with pytest.raises(InputError, match=says):
        make_machine("quadruped", replace(load_model("leg"), **change))


def test_a_delay_between_steps_is_refused() -> None:
    model = load_model("leg")
    with pytest.raises(InputError, match="not a whole number"):
        make_machine("leg", replace(model, actuators=replace(model.actuators, delay_s=0.004)))


def _on_its_ground(**effects: dict[str, Estimate]) -> Model:
    leg = load_model("leg_on_plate")
    added = tuple(AppliedEffect(EffectKey(name, None), p) for name, p in effects.items())
    return replace(leg, effects=(*leg.effects, *added))


def test_friction_found_of_the_ground_is_under_all_feet() -> None:
    found = _on_its_ground(ground_friction={"coefficient": Estimate(0.31, 0.02, "1")})
    made = make_machine("quadruped", found)
    assert made.left_out == ()
    np.testing.assert_allclose(made.mujoco.pair_friction[:, :2], 0.31)
    drawn = world_fields(made, Randomisation(), 64, 0)["pair_friction"][:, :, 0]
    assert drawn.shape == (64, 4) and np.ptp(drawn, axis=1).max() == 0.0
    assert drawn.mean() == pytest.approx(0.31, abs=0.01) and 0.01 < drawn.std() < 0.03
    # a foot that is dragged feels it
    m, data = made.mujoco, mujoco.MjData(made.mujoco)
    data.qpos[3], data.qpos[2], data.qpos[made.places] = 1.0, made.height - 0.002, made.posture
    data.qvel[0] = 1.0
    mujoco.mj_forward(m, data)
    force, total = np.zeros(6), np.zeros(3)
    for k in range(data.ncon):
        mujoco.mj_contactForce(m, data, k, force)
        total += force[:3]
    assert data.ncon == 4 and np.hypot(*total[1:]) == pytest.approx(0.31 * total[0], rel=0.02)


def test_a_floor_that_gives_way_is_laid_under_a_short_step() -> None:
    soft = {"stiffness": Estimate(1500.0, 0.0, "N/m"), "damping": Estimate(5.0, 0.0, "N*s/m")}
    made = make_machine("quadruped", _on_its_ground(contact_compliance=soft))
    assert made.left_out == ()
    m, data = made.mujoco, mujoco.MjData(made.mujoco)
    data.qpos[3], data.qpos[made.places] = 1.0, made.posture
    # held in its posture, it sinks in by its weight over four stiffnesses
    weight = 9.81 * m.body_subtreemass[0]
    data.qpos[2] = made.height - weight / (4 * 1500.0)
    mujoco.mj_forward(m, data)
    force, pressed = np.zeros(6), []
    for k in range(data.ncon):
        mujoco.mj_contactForce(m, data, k, force)
        pressed.append(force[0])
    assert sum(pressed) == pytest.approx(weight, rel=0.05)
    hard = {"stiffness": Estimate(2e5, 0.0, "N/m"), "damping": Estimate(50.0, 0.0, "N*s/m")}
    assert make_machine("quadruped", _on_its_ground(contact_compliance=hard)).left_out == (
        "contact_compliance",
    )
