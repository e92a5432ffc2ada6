"""The paper's equations agree with each other, with its table, and with what MuJoCo makes of the models."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.effects import load_model
from workbench.s3n import closed_forms as paper
from workbench.s3n import variant_dynamics, with_variant
from workbench.serial_tree import SerialTree

DRIVES = np.array([0.0162, 0.0162])
TOTAL = (0.04793, 0.005413, 0.02368)  # M11, M12, M22 of M_p, actuators included (paper)
ALPHA = np.linspace(-np.pi, np.pi, 25)
#: M_s at a knee angle of 90 degrees: M11, M12, M22 [kg m^2] (paper).
PAPER = {
    "kin_only": (0.04058, 0.00232, 0.01852),
    "s3n_act": (0.05678, 0.01852, 0.01852),
    "s3n_full": (0.07161, 0.02368, 0.02368),
    "s3n_full_paper": (0.07161, 0.02368, 0.02368),
    "exact": (0.07161, 0.02368, 0.02368),
}


def serial_links(alpha: np.ndarray) -> np.ndarray:
    """M_link^s of the reference leg's serial tree, (N, 2, 2), by Pinocchio."""
    postures = np.stack([np.zeros_like(alpha), alpha], axis=1)
    return SerialTree(load_model("leg_kin_only")).link_mass_matrix(postures)


def states(count: int = 10, seed: int = 3) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(seed)
    return generator.uniform(-1.5, 1.5, (count, 2)), generator.normal(0, 8, (count, 2))


def test_pulled_back_inertia_and_damping_of_the_drives() -> None:
    j1, j2 = 0.011, 0.017
    np.testing.assert_allclose(paper.pulled_back((j1, j2)), [[j1 + j2, j2], [j2, j2]])
    np.testing.assert_allclose(paper.actuator_increment((j1, j2)), [[j2, j2], [j2, 0.0]])
    assert paper.reflected(9.0, 0.0002) == pytest.approx(0.0162)


def test_both_expressions_of_the_residual_inertia_are_one() -> None:
    total, links = paper.parallel_inertia(*TOTAL, ALPHA), serial_links(ALPHA)
    first = paper.residual_from_links(paper.link_inertia(total, DRIVES), links)
    act = paper.actuator_increment(DRIVES)
    second = paper.residual_from_total(total, paper.serial_inertia(links, DRIVES) + act)
    np.testing.assert_allclose(first, second, atol=1e-16)
    whole = paper.normalised(paper.serial_inertia(links, DRIVES), act, first)
    np.testing.assert_allclose(whole, paper.to_serial(total), atol=1e-16)


def test_the_shipped_linkage_is_the_residual_inertia() -> None:
    linkage = load_model("leg").linkage
    assert linkage is not None
    stated = paper.to_serial(paper.parallel_inertia(linkage.M11, linkage.M12, linkage.M22, ALPHA))
    total = paper.parallel_inertia(*TOTAL, ALPHA)
    found = paper.residual_from_links(paper.link_inertia(total, DRIVES), serial_links(ALPHA))
    np.testing.assert_allclose(stated, found, atol=1e-6)


@pytest.mark.parametrize("variant", PAPER)
def test_the_papers_table_at_a_right_angle(variant: str) -> None:
    q = np.array([[0.3, np.pi / 2]])
    mass = variant_dynamics(load_model("leg"), variant, q, np.zeros((1, 2))).mass[0]
    np.testing.assert_allclose((mass[0, 0], mass[0, 1], mass[1, 1]), PAPER[variant], atol=5e-6)


def test_variants_differ_by_the_papers_increments() -> None:
    model, (q, v) = load_model("leg_kin_only"), states()
    linkage = model.linkage
    assert linkage is not None
    kin, act, full, to_the_letter, exact = (variant_dynamics(model, name, q, v) for name in PAPER)
    np.testing.assert_allclose(act.mass, kin.mass + paper.actuator_increment(DRIVES), atol=1e-15)
    increment = paper.actuator_increment(model.actuators.damping)
    np.testing.assert_allclose(act.damping, kin.damping + increment, atol=1e-15)
    residual = paper.to_serial(paper.parallel_inertia(linkage.M11, linkage.M12, linkage.M22, q[:, 1]))
    np.testing.assert_allclose(full.mass, act.mass + residual, atol=1e-8)
    velocity = paper.residual_velocity_torque(linkage.M12, q, v)
    np.testing.assert_allclose(full.bias, kin.bias + velocity, atol=1e-6)
    np.testing.assert_allclose(to_the_letter.bias, kin.bias, atol=1e-6)
    np.testing.assert_allclose(to_the_letter.mass, full.mass, atol=0)
    np.testing.assert_allclose(full.gravity, kin.gravity, atol=1e-6)
    g = paper.JACOBIAN.T @ np.diag([linkage.g1, linkage.g2])
    np.testing.assert_allclose(exact.gravity, full.gravity - np.sin(q @ paper.JACOBIAN.T) @ g.T, atol=2e-6)


def test_velocity_terms_belong_to_their_inertia() -> None:
    """M_dot - 2 C keeps no power: v^T (dM/dt v / 2 - C v) = 0 for any state."""
    q, v = states()
    h, m12 = 1e-6, 0.003

    def inertia(alpha: np.ndarray) -> np.ndarray:
        return paper.to_serial(paper.parallel_inertia(0.01, m12, 0.005, alpha))

    rate = (inertia(q[:, 1] + h * v[:, 1]) - inertia(q[:, 1] - h * v[:, 1])) / (2 * h)
    power = np.einsum("ni,nij,nj->n", v, rate, v) / 2
    np.testing.assert_allclose(
        np.einsum("ni,ni->n", v, paper.residual_velocity_torque(m12, q, v)), power, atol=1e-6
    )


def test_a_model_becomes_any_variant_and_keeps_its_effects() -> None:
    from tests.simulation.make import having
    from workbench.core import EffectKey

    model = having(load_model("leg"), EffectKey("viscous_damping", "hip"), damping=0.3)
    kin = with_variant(model, "kin_only")
    assert [e.key.effect for e in kin.effects] == ["viscous_damping"]
    again = with_variant(kin, "exact")
    assert {str(e.key) for e in again.effects} == {str(e.key) for e in model.effects}
    assert again.variant == "exact"
