"""The normalised tree is plain MJCF: read by MuJoCo alone it has the model's dynamics and moves like it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from tests.models.make import leg_file
from tests.simulation.make import having, leg_experiment, simulated
from workbench.core import Controller, EffectKey, InputError
from workbench.effects import compile_plant, load_model
from workbench.models import Linkage, Model
from workbench.s3n import (
    floating_base_error,
    normalise,
    run_variant,
    with_variant,
    write_normalised,
)

from .dynamics import same_dynamics

VARIANTS = ["kin_only", "s3n_act", "s3n_full", "exact"]


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_file_alone_has_the_models_dynamics(variant: str, tmp_path: Path) -> None:
    model = load_model("leg")
    file = write_normalised(normalise(model, variant), tmp_path / "leg.xml")
    m = mujoco.MjModel.from_xml_path(str(file))
    same_dynamics(with_variant(model, variant), m)
    # the cheapest form: no body more than the user's, a tendon only for the drive that moves two joints
    assert m.nbody == 3 and m.ntendon == 1 and m.ngravcomp == (variant in ("s3n_full", "exact"))
    assert [m.actuator(i).name for i in range(m.nu)] == ["hip", "knee"]
    assert m.tendon_armature[m.tendon("knee").id] == (0.0 if variant == "kin_only" else 0.0162)


def test_all_that_mujoco_holds_is_in_the_file() -> None:
    model = load_model("leg")
    model = replace(model, actuators=replace(model.actuators, delay_s=0.0))
    for key, values in (
        (EffectKey("viscous_damping", "knee", "joint"), {"damping": 0.04}),
        (EffectKey("viscous_damping", "hip"), {"damping": 0.03}),
        (EffectKey("parallel_spring", "knee"), {"stiffness": 1.3, "rest": 0.4}),
        (EffectKey("parallel_spring", "knee", "joint"), {"stiffness": 0.7, "rest": 1.0}),
        (EffectKey("parallel_spring", "hip"), {"stiffness": 0.9, "rest": -0.4}),
        (EffectKey("reflected_inertia", "knee"), {"inertia": 0.002}),
        (EffectKey("payload_mass", None), {"mass": 0.2}),
        (EffectKey("torque_constant_error", "hip"), {"gain": 1.1}),
        (EffectKey("torque_bias", "knee"), {"torque": 0.3}),
        (EffectKey("coulomb_friction", "hip"), {"torque": 0.2}),
        (EffectKey("coulomb_friction", "hip", "joint"), {"torque": 0.1}),
        (EffectKey("coulomb_friction", "knee"), {"torque": 0.3}),
    ):
        model = having(model, key, **values)
        tree = normalise(model, integrator=None)
        assert not tree.left_out
        same_dynamics(model, tree.mujoco)
        follows(model, tree.mujoco)


BENDING = [
    (EffectKey("joint_compliance", "hip"), {"stiffness": 60.0, "damping": 0.1}),
    (EffectKey("joint_compliance", "knee"), {"stiffness": 60.0, "damping": 0.1}),
    (EffectKey("joint_compliance", "knee", "joint"), {"stiffness": 60.0, "damping": 0.1}),
    (EffectKey("backlash", "hip"), {"gap": 0.01, "stiffness": 60.0}),
    (EffectKey("backlash", "knee", "joint"), {"gap": 0.01, "stiffness": 60.0}),
    (EffectKey("base_compliance", None), {"stiffness": 2e4, "damping": 40.0, "mass": 10.0}),
    (EffectKey("link_length_error", "hip"), {"length": 0.02}),
]


@pytest.mark.parametrize(("key", "values"), BENDING, ids=lambda x: str(x) if isinstance(x, EffectKey) else "")
def test_what_bends_is_in_the_file(key: EffectKey, values: dict[str, float]) -> None:
    model = load_model("leg")
    model = replace(model, actuators=replace(model.actuators, delay_s=0.0))
    model = having(model, EffectKey("coulomb_friction", "knee"), torque=0.1)
    model = having(model, key, **values)
    tree = normalise(model, integrator=None)
    assert not tree.left_out
    follows(model, tree.mujoco)


def test_damping_that_begins_at_a_flank_is_said_to_be_left_out() -> None:
    model = replace(load_model("leg"), flank_retardation_s=2e-3)
    tree = normalise(having(model, BENDING[3][0], **BENDING[3][1]), integrator=None)
    assert tree.left_out == ("damping of flanks",) and "damping of flanks" in tree.xml
    assert not np.any(tree.mujoco.tendon_damping[tree.mujoco.tendon("flex:actuator:0").id])
    assert not normalise(model, integrator=None).left_out, "a model without play has no flanks"


def test_a_base_and_springs_at_drives_and_pins_are_one_tree() -> None:
    model = load_model("leg")
    for key, values in (BENDING[0], BENDING[2], BENDING[5]):
        model = having(model, key, **values)
    m = normalise(model).mujoco
    assert {m.joint(i).name for i in range(m.njnt)} >= {"hip", "knee", "base:x"} and m.njnt == 5
    assert m.jnt_stiffness[m.joint("base:x").id] == 2e4


def test_motors_answer_late_by_the_models_delay() -> None:
    """Commands reach the drives as late as if they had been held back by hand; fractions of a step too."""
    late = having(load_model("leg"), EffectKey("command_delay", None), time=0.0015)
    prompt = replace(late, actuators=replace(late.actuators, delay_s=0.0), effects=late.effects[:-1])
    forces = []
    for model in (late, prompt):
        m = normalise(model).mujoco
        data, track = mujoco.MjData(m), []
        for step in range(30):
            data.ctrl[:] = 0.5 * step
            mujoco.mj_step(m, data)
            track.append(data.actuator_force[1])
        forces.append(np.array(track))
    shifted = np.interp(np.arange(30) - 4.5, np.arange(30), forces[1])
    np.testing.assert_allclose(forces[0][5:], shifted[5:], atol=1e-9)


def follows(model: Model, m: mujoco.MjModel) -> None:
    """The file moves under commands as the workbench's own simulation of the model does."""
    loop = Controller("none", "actuator")
    recording = leg_experiment(0.3, controller=loop, amplitude=0.2)
    t = recording.time
    command = (
        np.stack([26.0 * np.sin(25 * t), 4.0 * np.cos(40 * t)], axis=1) * np.clip(t / 0.1, 0, 1)[:, None]
    )
    recording = replace(recording, signals={**recording.signals, "torque_command": command})
    wanted = simulated(model, recording)
    data = mujoco.MjData(m)
    start = np.linalg.solve(model.transmission, recording.position[0])
    plant = compile_plant(model)
    for value, own in zip(plant.state_at(np.stack([start, start]))[0], range(plant.mujoco.njnt), strict=True):
        data.qpos[m.joint(plant.mujoco.joint(own).name).qposadr[0]] = value
    order = [m.joint(plant.mujoco.joint(i).name).qposadr[0] for i in range(plant.mujoco.njnt)]
    track = [plant.drives @ data.qpos[order]]
    # the file's own timestep may be too long for its springs, of which its header warns
    m.opt.timestep /= plant.substeps
    for row in range(len(t) - 1):
        data.ctrl[:] = command[row]
        mujoco.mj_step(m, data, plant.substeps)
        track.append(plant.drives @ data.qpos[order])
    np.testing.assert_allclose(np.array(track), wanted.position, atol=1e-6)


def test_what_needs_a_torque_function_is_named() -> None:
    model = having(
        load_model("leg"), EffectKey("stribeck_friction", "knee"), coulomb=0.1, static=0.2, speed=0.1
    )
    model = having(model, EffectKey("viscous_damping", "hip"), damping=0.1)
    tree = normalise(model)
    assert tree.left_out == ("stribeck_friction@knee",)
    assert "stribeck_friction@knee" in tree.xml and "function at every step" in tree.xml


def test_a_shank_heavy_off_its_line_keeps_bodies_of_its_own(tmp_path: Path) -> None:
    """One gravity compensation cannot turn a weight's direction."""
    xml = (load_model("leg").serial).read_text().replace('pos="0 0 -0.09"', 'pos="0.02 0.01 -0.09"')
    (tmp_path / "crooked.xml").write_text(xml)
    model = replace(load_model("leg"), serial=tmp_path / "crooked.xml")
    tree = normalise(model)
    same_dynamics(model, tree.mujoco)
    assert tree.mujoco.nbody > 3
    assert all(tree.mujoco.body(i).name for i in range(tree.mujoco.nbody))


def test_a_model_file_can_be_normalised_without_a_linkage(tmp_path: Path) -> None:
    model = load_model(leg_file(tmp_path, variant="s3n_act", linkage=None))
    same_dynamics(model, normalise(model).mujoco)
    with pytest.raises(InputError, match="linkage"):
        normalise(model, "s3n_full")


def test_a_transmission_that_changes_with_posture_is_refused() -> None:
    turning = replace(load_model("leg"), posture_dependent=True)
    for refused in (lambda: normalise(turning), lambda: run_variant(turning, "exact", np.zeros((2, 2)))):
        with pytest.raises(InputError, match="does not change with the posture"):
            refused()


def test_a_free_base_feels_what_the_tree_has_not() -> None:
    leg = load_model("leg")
    kin, full, exact = (floating_base_error(leg, name) for name in ("kin_only", "s3n_full", "exact"))
    assert kin.true_mass == pytest.approx(2.13, abs=1e-6) and kin.mass == pytest.approx(1.96, abs=1e-6)
    assert kin.mass < exact.mass < exact.true_mass
    assert exact.coupling < full.coupling < kin.coupling
    assert exact.moment < 1e-6 < kin.moment  # the moment of the weights is the closed chain's
    assert 0.0 < exact.true_weight - exact.weight < kin.true_weight - kin.weight


@settings(max_examples=15, deadline=None)
@example(m11=0.0078125, m22=0.015625, ratio=0.0, gravity=(1.0, 0.25))  # links heavier than their masses
@given(
    m11=st.floats(0.002, 0.05),
    m22=st.floats(0.001, 0.02),
    ratio=st.floats(-0.9, 0.9),
    gravity=st.tuples(st.floats(-0.5, 1.0), st.floats(-0.5, 1.0)),
)
def test_any_linkage_that_a_body_can_have(
    m11: float, m22: float, ratio: float, gravity: tuple[float, float]
) -> None:
    linkage = Linkage(m11, ratio * np.sqrt(m11 * m22), m22, *gravity, identified=True)
    model = with_variant(replace(load_model("leg_kin_only"), linkage=linkage), "exact")
    assume(abs(linkage.M12 + 0.00252) > 1e-5)  # a shank without first moment has no weight to lift
    same_dynamics(model, normalise(model).mujoco, 1e-10)
