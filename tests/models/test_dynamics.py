"""The compiled models have the inertia, velocity terms and gravity that paper and closed chain give."""

import mujoco
import numpy as np
import pytest

from workbench.effects import compile_plant, load_model
from workbench.models import Model
from workbench.rigs import ClosedChain

#: M_s at a knee angle of 90 degrees: M11, M12, M22 [kg m^2].
PAPER = {
    "leg_kin_only": (0.04058, 0.00232, 0.01852),
    "leg_s3n_act": (0.05678, 0.01852, 0.01852),
    "leg_s3n_full": (0.07161, 0.02368, 0.02368),
}
ACTUATOR_INERTIA, ACTUATOR_DAMPING = 0.0162, 0.0972


def mass_matrix(model: Model, joints: np.ndarray) -> np.ndarray:
    """M_s (n, n) at serial joint positions."""
    m = compile_plant(model).mujoco
    data = mujoco.MjData(m)
    data.qpos[:] = joints
    mujoco.mj_forward(m, data)
    full = np.zeros((m.nv, m.nv))
    mujoco.mj_fullM(m, data, full)
    return full


def needed(model: Model, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Motor torque (n,) for a state and acceleration in actuator coordinates."""
    m, j = compile_plant(model).mujoco, model.transmission
    data = mujoco.MjData(m)
    data.qpos[:], data.qvel[:], data.qacc[:] = (np.linalg.solve(j, x) for x in (q, v, a))
    mujoco.mj_inverse(m, data)
    return np.linalg.solve(j.T, data.qfrc_inverse)


@pytest.mark.parametrize("name", PAPER)
def test_the_papers_table_at_a_right_angle(name: str) -> None:
    mass = mass_matrix(load_model(name), np.array([0.3, np.pi / 2]))
    np.testing.assert_allclose((mass[0, 0], mass[0, 1], mass[1, 1]), PAPER[name], atol=1e-6)


def test_the_exact_leg_has_the_gravity_of_the_linkage() -> None:
    leg, still = load_model("leg"), np.zeros(2)
    for q in np.random.default_rng(1).uniform(-2, 2, (10, 2)):
        torque = needed(leg, q, still, still)
        np.testing.assert_allclose(torque, [1.850411 * np.sin(q[0]), 0.274007 * np.sin(q[1])], atol=2e-6)


def test_the_exact_leg_is_drakes_closed_chain() -> None:
    leg = load_model("leg")
    assert leg.closed_chain is not None
    chain = ClosedChain(leg.closed_chain.file)
    generator = np.random.default_rng(2)
    for _ in range(20):
        q, v, a = generator.uniform(-1.5, 1.5, 2), generator.normal(0, 8, 2), generator.normal(0, 200, 2)
        reduced = chain.reduced_dynamics(q, v)
        mass = reduced.mass + ACTUATOR_INERTIA * np.eye(2)
        expected = mass @ a + reduced.bias - reduced.gravity + ACTUATOR_DAMPING * v
        np.testing.assert_allclose(needed(leg, q, v, a), expected, atol=2e-5)


def test_the_serial_tree_alone_is_not_the_closed_chain() -> None:
    q, v, a = np.array([0.4, 1.2]), np.array([1.0, -2.0]), np.array([30.0, 50.0])
    difference = needed(load_model("leg"), q, v, a) - needed(load_model("leg_kin_only"), q, v, a)
    assert np.abs(difference).min() > 0.1
