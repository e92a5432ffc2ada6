"""A mechanism as plain MJCF: near the closed chain, a machine that can be built, its error stated."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from posture_schedule import Schedule
from posture_worlds import ScheduledWorld

from tests.s3n.postures import drake, model, series, states
from tests.simulation.make import having
from workbench.core import EffectKey, Estimate, InputError
from workbench.effects import load_model
from workbench.models import AppliedEffect, Model, load_mjcf, read_model
from workbench.s3n import compiled_dynamics
from workbench.s3n.normalise import write_normalised
from workbench.s3n.posture import PostureDependent
from workbench.s3n.posture_error import relative_inertia
from workbench.s3n.posture_fitted import FittedTree, fit_native


@pytest.fixture(scope="module")
def fitted() -> FittedTree:
    own = model("four_bar")
    at_once = replace(own, actuators=replace(own.actuators, delay_s=0.0))
    return fit_native(at_once, branches=8, chain=series("four_bar"))


def one_drive(folder: Path) -> Model:
    """The four-bar with its hip held: one drive, one joint."""
    own = model("four_bar")
    assert own.closed_chain is not None
    chain, tree = own.closed_chain.file.read_text(), own.serial.read_text()
    welded = chain.replace('<joint name="hip" type="revolute">', '<joint name="hip" type="fixed">')
    hip = '      <joint name="hip" type="hinge" axis="0 -1 0" limited="false" range="-1.6 1.6"/>\n'
    assert welded != chain and hip in tree
    (folder / "one.sdf").write_text(welded)
    (folder / "one.xml").write_text(tree.replace(hip, ""))
    start = (("knee", 1.2), ("crank_pin", 1.214401), ("coupler_pin", -1.534512))
    return replace(
        own, name="one", axes=("knee",), joints=("knee",), serial=folder / "one.xml",
        transmission=np.array([[0.79]]), payload_site=None,
        actuators=replace(own.actuators, inertia=(0.0162,), damping=(0.0972,), torque_limit=(24.0,)),
        closed_chain=replace(
            own.closed_chain, file=folder / "one.sdf", drives=("crank_pin",), joints=("knee",), start=start,
            limits=((0.5, 2.4),),
        ),
    )  # fmt: skip


def test_it_is_near_the_closed_chain(fitted: FittedTree) -> None:
    """Held against Drake, at states that were not fitted."""
    q, v = states("four_bar", 40, seed=11)
    ours = compiled_dynamics(fitted.mujoco, ("hip", "knee"), q, v)
    chain, rotor = drake("four_bar"), np.diag(model("four_bar").actuators.inertia)
    j = np.array([chain.jacobian(x) for x in q])
    real = (
        np.array([chain.serial_dynamics(x, np.zeros(2)).mass for x in q]) + j.transpose(0, 2, 1) @ rotor @ j
    )
    off = np.abs(relative_inertia(ours.mass, real)).max()
    assert off <= 1.01 * fitted.error.inertia_max < 0.01  # stated on a grid
    assert fitted.error.gravity_rms < 0.01 and fitted.error.velocity_rms < 0.1


def test_its_motors_are_the_drives(fitted: FittedTree) -> None:
    """Length less offset is the drive's position, the moment is J, and rotor and drag are on it."""
    m, data, chain = fitted.mujoco, mujoco.MjData(fitted.mujoco), drake("four_bar")
    for x, v in zip(*states("four_bar", 20, seed=12), strict=True):
        data.qpos[:], data.qvel[:], data.ctrl[:] = x, v, [0.3, -1.2]
        mujoco.mj_forward(m, data)
        np.testing.assert_allclose(data.actuator_length - fitted.offsets, chain.drive_position(x), atol=2e-3)
        np.testing.assert_allclose(data.qfrc_actuator, chain.jacobian(x).T @ data.ctrl, atol=0.02)
        drag = chain.jacobian(x).T @ (0.0972 * chain.jacobian(x) @ v)
        np.testing.assert_allclose(data.qfrc_damper, -drag, atol=0.02)
    np.testing.assert_allclose(m.actuator_ctrlrange[:, 1], 24.0)


def test_its_velocity_terms_belong_to_its_inertia(fitted: FittedTree) -> None:
    q, v = states("four_bar", 10, seed=13)
    h = 1e-5
    ahead, behind = (
        compiled_dynamics(fitted.mujoco, ("hip", "knee"), q + s * h * v, v).mass for s in (1, -1)
    )
    bias = compiled_dynamics(fitted.mujoco, ("hip", "knee"), q, v).bias
    power = np.einsum("ni,nij,nj->n", v, (ahead - behind) / (2 * h), v) / 2
    np.testing.assert_allclose(np.einsum("ni,ni->n", v, bias), power, rtol=1e-4, atol=1e-5)


def test_its_bodies_can_be_built(fitted: FittedTree) -> None:
    m = fitted.mujoco
    inertia = np.sort(m.body_inertia[1:], axis=1)
    assert (m.body_mass[1:] > 0).all() and (inertia > 0).all()
    assert (inertia[:, 0] + inertia[:, 1] >= inertia[:, 2] * (1 - 1e-9)).all()
    assert (m.dof_armature >= 0).all() and (m.tendon_armature >= 0).all() and (m.tendon_damping >= 0).all()
    # the whole machine's mass: links, crank and coupler
    assert m.body_mass.sum() == pytest.approx(2.145, rel=0.02)


def test_links_are_the_files_where_motion_does_not_tell(fitted: FittedTree) -> None:
    """A link has its own mass, and less than all of the crank's and the coupler's beside it."""
    stated = load_mjcf(model("four_bar").serial).compile()
    omitted = 2.145 - stated.body_mass.sum()
    for name in ("thigh", "shank"):
        ours, own = fitted.mujoco.body(name), stated.body(name)
        assert own.mass[0] <= ours.mass[0] < own.mass[0] + omitted
        assert np.linalg.norm(ours.ipos - own.ipos) < 0.03


def test_the_file_says_what_it_is_off_by(fitted: FittedTree, tmp_path: Path) -> None:
    path = write_normalised(fitted, tmp_path / "four_bar.xml")
    text = path.read_text()
    assert f"inertia by up to {fitted.error.inertia_max:.2%}" in text
    again = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(again)
    data.qpos[:] = [0.2, 1.3]
    for _ in range(300):
        mujoco.mj_step(again, data)
    assert np.isfinite(data.qpos).all()
    assert any(entry.element == "body thigh" for entry in fitted.added)


def test_a_fit_that_is_worse_than_allowed_is_refused() -> None:
    leg = load_model("leg")
    with pytest.raises(InputError, match=r"off by up to 0\.\d+% \(at hip = .*0\.0% are allowed; allow more"):
        fit_native(leg, allow=1e-5)
    tree = fit_native(leg, allow=None)
    assert tree.error.inertia_max < 0.005
    assert not (tree.mujoco.tendon_type == mujoco.mjtTendon.mjTENDON_SPATIAL).any()
    with pytest.raises(InputError, match="0 branches"):
        fit_native(leg, branches=0)


def test_one_drive(tmp_path: Path) -> None:
    """A mechanism with one angle: the knee moves as that of the whole leg with its hip at rest."""
    alone = one_drive(tmp_path)
    chain = PostureDependent(alone)
    knee = np.linspace(0.5, 2.4, 9)[:, None]
    whole = series("four_bar").dynamics(np.concatenate([0 * knee, knee], axis=1))
    found = chain.dynamics(knee)
    np.testing.assert_allclose(found.mass[:, 0, 0], whole.mass[:, 1, 1], rtol=1e-7)
    np.testing.assert_allclose(found.gravity[:, 0], whole.gravity[:, 1], atol=1e-7)
    tree = fit_native(alone, branches=4, chain=chain)
    assert tree.error.inertia_max < 0.02
    world = ScheduledWorld(Schedule(alone), start=(np.array([1.2]), np.zeros(1)))
    world.advance(np.array([0.5]), 20)
    assert world.state()[0][0] > 1.2


def test_effects_are_left_out_by_name() -> None:
    leg = having(read_model("leg"), EffectKey("viscous_damping", "hip"), damping=0.3)
    assert "viscous_damping@hip" in fit_native(leg, allow=None).left_out


def test_effects_at_drives_are_in_the_file() -> None:
    """What acts at a drive as friction, rotor or motor; what is left out is told."""
    having_all = read_model("four_bar")
    keys = {
        "coulomb_friction": {"torque": 0.3},
        "viscous_damping": {"damping": 0.05},
        "reflected_inertia": {"inertia": 0.002},
        "torque_constant_error": {"gain": 0.9},
        "parallel_spring": {"stiffness": 1.0, "rest": 0.2},
        "encoder_offset": {"angle": 0.02},
    }
    for name, values in keys.items():
        parameters = {key: Estimate(value, 0.0, "") for key, value in values.items()}
        having_all = having_all.with_effect(AppliedEffect(EffectKey(name, "knee"), parameters))
    own = replace(having_all, effects=())
    bare, made = (fit_native(m, chain=series("four_bar")) for m in (own, having_all))
    assert made.left_out == ("parallel_spring@knee", "encoder_offset@knee")
    knee = made.mujoco.tendon("knee").id
    for field, more in (("frictionloss", 0.3), ("damping", 0.05), ("armature", 0.002)):
        before, after = (getattr(m.mujoco, f"tendon_{field}")[knee] for m in (bare, made))
        assert np.ravel(after - before)[0] == pytest.approx(more)
    assert made.mujoco.actuator("knee").gainprm[0] == pytest.approx(0.9)
    assert made.error.inertia_max == bare.error.inertia_max
