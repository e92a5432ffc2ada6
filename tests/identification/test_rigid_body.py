"""Ten numbers of a body and its pseudo-inertia, which has no negative eigenvalue if the body can exist."""

import numpy as np
import pytest

from workbench.effects import link_of, load_model
from workbench.identification.rigid_body import (
    DIRECTIONS,
    Belief,
    inertial_of,
    numbers_of,
    pseudo_inertia,
)
from workbench.models import Inertial


def points(seed: int) -> tuple[np.ndarray, np.ndarray, Inertial]:
    """Masses (20,) at points (20, 3), and what these are as one body."""
    generator = np.random.default_rng(seed)
    masses, at = generator.uniform(0.1, 1.0, 20), generator.normal(0.1, 0.2, (20, 3))
    centre = masses @ at / masses.sum()
    off = at - centre
    tensor = np.einsum(
        "k,kij->ij", masses, (off**2).sum(1)[:, None, None] * np.eye(3) - off[:, :, None] * off[:, None]
    )
    return masses, at, Inertial(float(masses.sum()), centre, tensor)


def test_pseudo_inertia_is_the_sum_over_points():
    masses, at, body = points(1)
    homogeneous = np.column_stack([at, np.ones(len(at))])
    expected = np.einsum("k,ki,kj->ij", masses, homogeneous, homogeneous)
    np.testing.assert_allclose(pseudo_inertia(numbers_of(body)), expected, rtol=1e-12)


def test_numbers_and_body_are_inverse():
    body = points(2)[2]
    back = inertial_of(numbers_of(body))
    assert back.mass == pytest.approx(body.mass)
    np.testing.assert_allclose(back.centre, body.centre)
    np.testing.assert_allclose(back.tensor, body.tensor)


def test_body_that_cannot_exist_has_a_negative_eigenvalue():
    body = Inertial(1.0, np.zeros(3), np.diag([0.01, 0.01, 0.03]))  # more about z than about x and y together
    assert np.linalg.eigvalsh(pseudo_inertia(numbers_of(body)))[0] < -1e-3


def test_directions_are_square_to_each_other():
    flat = DIRECTIONS.reshape(10, 16)
    np.testing.assert_allclose(flat @ flat.T, np.eye(10), atol=1e-15)


def test_a_step_of_a_belief_is_of_the_body_s_own_size(tmp_path):
    """A link ten times as heavy and twice as long takes the same steps to become another one altogether."""
    light, heavy = (belief(tmp_path, mass, size) for mass, size in ((1.0, 0.1), (10.0, 0.2)))
    for one in (light, heavy):
        np.testing.assert_allclose(one.start, np.eye(4), atol=1e-9)
    np.testing.assert_allclose(heavy.unit[0], 10.0 * light.unit[0], atol=1e-9)
    np.testing.assert_allclose(heavy.unit[4], 40.0 * light.unit[4], atol=1e-9)


def test_a_point_mass_is_taken_for_a_small_body(tmp_path):
    one = belief(tmp_path, 1.0, 0.1, inertia=1e-9)
    assert np.linalg.eigvalsh(one.start)[0] < 1e-3  # the file's body, where the identity is a thicker one
    assert np.isfinite(one.unit).all()


def belief(folder, mass: float, size: float, inertia: float | None = None) -> Belief:
    """Of a link on a hinge; its inertia is that of a ball unless stated."""
    own = 0.4 * mass * size**2 if inertia is None else inertia
    file = folder / f"{mass}_{inertia}.xml"
    file.write_text(
        f"""<mujoco><worldbody><body name="arm"><joint name="turn" axis="0 1 0"/>
        <inertial pos="{size} 0 0" mass="{mass}" diaginertia="{own} {own} {own}"/></body></worldbody>
        <actuator><motor joint="turn"/></actuator></mujoco>"""
    )
    link = link_of(load_model(file), "turn")
    assert link is not None
    return Belief.of(link)
