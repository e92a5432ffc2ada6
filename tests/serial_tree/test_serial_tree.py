"""Pinocchio and MuJoCo are two engines of one tree: masses, velocity terms, gravity, sites, energy."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.models.make import machine_file
from workbench.core import InputError
from workbench.effects import compile_plant, load_model
from workbench.models import Model, read_model
from workbench.serial_tree import SerialTree

#: M_s at a knee angle of 90 degrees: M11, M12, M22 [kg m^2] (paper).
PAPER = {
    "leg_kin_only": (0.04058, 0.00232, 0.01852),
    "leg_s3n_act": (0.05678, 0.01852, 0.01852),
    "leg_s3n_full": (0.07161, 0.02368, 0.02368),
}
#: Three joints on one body, off its origin, of two kinds, with reference positions; a branch; a welded tool.
KNOT_XML = """
<mujoco>
  <compiler angle="radian"/>
  <option gravity="0.4 -1.1 -9.5"/>
  <worldbody>
    <body pos="0.1 0.2 0.3" euler="0.2 -0.4 0.6">
      <joint name="turn" axis="1 2 -0.5" pos="0.05 -0.02 0.1" ref="0.3" armature="0.02" damping="0.1"/>
      <joint name="slide" type="slide" axis="0 1 1" ref="-0.1"/>
      <joint name="twist" axis="0 0 1" pos="0.2 0 0"/>
      <inertial pos="0.1 0 0.05" mass="1.3" fullinertia="0.02 0.03 0.025 0.001 -0.002 0.003"/>
      <body pos="0 0.3 0" quat="0.9 0.1 0.3 -0.2" gravcomp="0.4">
        <joint name="branch" axis="0 1 0"/>
        <geom type="box" size="0.1 0.05 0.02" mass="0.7"/>
        <body pos="0.1 0 0" euler="0 0.5 0">
          <geom type="sphere" size="0.03" mass="0.2" pos="0 0.02 0"/><site name="tip" pos="0.01 0.02 0.03"/>
        </body>
      </body>
      <body pos="0.2 0 0.1">
        <joint name="other" axis="1 0 0"/><geom size="0.05" mass="0.4" pos="0 0.1 0"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed armature="0.03" damping="0.2">
      <joint joint="twist" coef="2"/><joint joint="branch" coef="-1"/>
    </fixed>
  </tendon>
</mujoco>
"""


@pytest.fixture
def knot(tmp_path: Path) -> Model:
    file = tmp_path / "knot.xml"
    file.write_text(KNOT_XML)
    return read_model(file)


def motions(size: int, count: int = 8, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    generator = np.random.default_rng(seed)
    q, v, a = (scale * generator.normal(size=(count, size)) for scale in (1.0, 3.0, 20.0))
    return q, v, a


def by_mujoco(
    m: mujoco.MjModel, joints: tuple[str, ...], q: np.ndarray, v: np.ndarray, a: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Mass matrices (N, k, k) and the torque that a motion needs (N, k)."""
    data = mujoco.MjData(m)
    dofs = [m.joint(name).dofadr[0] for name in joints]
    masses, torques = [], []
    for row in range(len(q)):
        data.qpos[dofs], data.qvel[dofs], data.qacc[dofs] = q[row], v[row], a[row]
        mujoco.mj_inverse(m, data)
        full = np.zeros((m.nv, m.nv))
        mujoco.mj_fullM(m, data, full)
        masses.append(full[np.ix_(dofs, dofs)])
        torques.append(data.qfrc_inverse[dofs].copy())
    return np.array(masses), np.array(torques)


def agree(tree: SerialTree, m: mujoco.MjModel) -> None:
    q, v, a = motions(tree.size)
    m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_SPRING)
    mass, torque = by_mujoco(m, tree.joints, q, v, a)
    np.testing.assert_allclose(tree.mass_matrix(q), mass, rtol=0, atol=1e-12 * np.abs(mass).max())
    needed = tree.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(needed, torque, rtol=0, atol=1e-12 * np.abs(torque).max())


@pytest.mark.parametrize("name", ["leg_kin_only", "leg_s3n_act", "leg_s3n_full", "leg", "emps"])
def test_pinocchio_is_mujoco(name: str) -> None:
    model = load_model(name)
    plant = compile_plant(model).mujoco
    agree(SerialTree(model, plant), plant)


def test_any_tree_of_hinges_and_slides(knot: Model, tmp_path: Path) -> None:
    for model in (knot, read_model(machine_file(tmp_path))):
        plant = compile_plant(model).mujoco
        agree(SerialTree(model, plant), plant)


@pytest.mark.parametrize("name", PAPER)
def test_the_papers_table_at_a_right_angle(name: str) -> None:
    model = load_model(name)
    mass = SerialTree(model, compile_plant(model).mujoco).mass_matrix(np.array([[0.3, np.pi / 2]]))[0]
    np.testing.assert_allclose((mass[0, 0], mass[0, 1], mass[1, 1]), PAPER[name], atol=1e-6)


def test_without_a_compiled_model_it_is_the_tree_with_actuators() -> None:
    q = np.array([[0.3, np.pi / 2]])
    mass = SerialTree(load_model("leg")).mass_matrix(q)[0]
    np.testing.assert_allclose(mass[[0, 0, 1], [0, 1, 1]], PAPER["leg_kin_only"], atol=1e-6)


def kinetic_energy(tree: SerialTree, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    return 0.5 * np.einsum("ni,nij,nj->n", v, tree.mass_matrix(q), v)


def test_power_is_the_rate_of_energy(knot: Model) -> None:
    tree = SerialTree(knot, compile_plant(knot).mujoco)
    q, v, a = motions(tree.size)
    h = 1e-6
    after, before = (
        kinetic_energy(tree, q + s * v, v + s * a) + tree.potential_energy(q + s * v) for s in (h, -h)
    )
    supplied = np.einsum("ni,ni->n", v, tree.inverse_dynamics(q, v, a) - v @ tree.damping)
    np.testing.assert_allclose((after - before) / (2 * h), supplied, rtol=1e-6, atol=1e-6)


def test_sites_are_where_mujoco_has_them(knot: Model) -> None:
    plant = compile_plant(knot).mujoco
    tree, data = SerialTree(knot, plant), mujoco.MjData(plant)
    q, _, _ = motions(tree.size)
    position, jacobian = tree.site_position("tip", q), tree.site_jacobian("tip", q)
    for row in range(len(q)):
        data.qpos[:] = q[row]
        mujoco.mj_forward(plant, data)
        expected = np.zeros((3, plant.nv))
        mujoco.mj_jacSite(plant, data, expected, None, plant.site("tip").id)
        np.testing.assert_allclose(position[row], data.site("tip").xpos, atol=1e-12)
        np.testing.assert_allclose(jacobian[row], expected, atol=1e-12)
    with pytest.raises(InputError, match="no site 'toe'"):
        tree.site_position("toe", q)


def test_coordinates_follow_the_models_order(tmp_path: Path) -> None:
    (tmp_path / "swapped.toml").write_text(
        'format = 1\nname = "swapped"\nserial = "serial/leg.xml"\naxes = ["knee", "hip"]\n'
    )
    q = np.array([[0.4, -0.7], [1.2, 0.1]])
    straight, swapped = SerialTree(load_model("leg")), SerialTree(read_model(tmp_path / "swapped.toml"))
    assert swapped.joints == ("knee", "hip")
    np.testing.assert_allclose(swapped.gravity(q[:, ::-1]), straight.gravity(q)[:, ::-1], atol=1e-14)
    with pytest.raises(InputError, match=r"\(N, 2\)"):
        swapped.gravity(q[0])


link = st.tuples(st.floats(0.05, 5.0), st.floats(-0.2, 0.2), st.floats(0.01, 0.3), st.floats(0.002, 0.1))


@settings(max_examples=25, deadline=None)
@given(links=st.lists(link, min_size=1, max_size=4), seed=st.integers(0, 1000))
def test_random_chains_have_positive_energy_and_agree(
    links: list[tuple[float, float, float, float]], seed: int
) -> None:
    spec = mujoco.MjSpec()
    body, names = spec.worldbody, []
    for i, (mass, across, along, radius) in enumerate(links):
        body = body.add_body(pos=[0.0, across, -along])
        body.add_joint(name=f"j{i}", axis=[0.3 * i, -1, 0.1])
        body.mass, body.ipos, body.explicitinertial = mass, [across, 0.0, -0.5 * along], True
        body.inertia = mass * radius**2 * np.array([1.0, 1.2, 0.7])
        names.append(f"j{i}")
    m = spec.compile()
    model = Model("chain", Path("chain.xml"), tuple(names), tuple(names), np.eye(len(names)), actuators=None)  # type: ignore[arg-type]
    tree = SerialTree(model, m)
    agree(tree, m)
    q, v, _ = motions(tree.size, seed=seed)
    assert (np.linalg.eigvalsh(tree.mass_matrix(q)) > 0).all()
    assert (kinetic_energy(tree, q, v) > 0).all()
