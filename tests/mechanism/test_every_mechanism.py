"""Mechanics that hold in every mechanism, whatever its loops are, all over its workspace."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.mechanism import ClosedChain, constant_transmission
from workbench.models import read_model

from .chains import NAMES, central, chain, joints_at, open_loop, quadruped

parts = st.tuples(*[st.floats(0.0, 1.0)] * 2)
speeds = st.tuples(*[st.floats(-5.0, 5.0)] * 2).map(np.array)
everywhere = settings(max_examples=10, deadline=None, derandomize=True)
every_mechanism = pytest.mark.parametrize("name", NAMES)


@every_mechanism
@given(parts)
@everywhere
def test_loops_close_and_positions_go_there_and_back(name: str, part: tuple[float, float]) -> None:
    mechanism, joints = chain(name), joints_at(name, part)
    drives = mechanism.drive_position(joints)
    assert open_loop(mechanism, drives) < 1e-12
    np.testing.assert_allclose(mechanism.serial_slope(drives)[0], joints, atol=1e-11)


@every_mechanism
@given(parts, speeds)
@everywhere
def test_velocities_are_derivatives_of_positions(name: str, part: tuple[float, float], v: np.ndarray) -> None:
    mechanism, joints = chain(name), joints_at(name, part)
    drives, jacobian = mechanism.drive_position(joints), mechanism.jacobian(joints)
    assert central(mechanism.drive_position, joints, v) == pytest.approx(jacobian @ v, abs=1e-6)
    assert central(mechanism.foot_position, joints, v) == pytest.approx(
        mechanism.foot_jacobian(joints) @ v, abs=1e-7
    )
    assert central(mechanism.tree_position, drives, v) == pytest.approx(
        mechanism.projection(drives) @ v, abs=1e-5
    )
    change = central(mechanism.jacobian, joints, v) @ v
    assert mechanism.jacobian_bias(joints, v) == pytest.approx(change, rel=1e-6, abs=1e-5)


@every_mechanism
@given(parts, speeds)
@everywhere
def test_mass_is_symmetric_positive_and_bias_does_no_work(
    name: str, part: tuple[float, float], v: np.ndarray
) -> None:
    """v . bias = v . M' v / 2 in either coordinates, the L' term included: kinetic energy is kept."""
    mechanism, joints = chain(name), joints_at(name, part)
    for dynamics, at in (
        (mechanism.reduced_dynamics, mechanism.drive_position(joints)),
        (mechanism.serial_dynamics, joints),
    ):
        reduced = dynamics(at, v)
        np.testing.assert_allclose(reduced.mass, reduced.mass.T, atol=1e-15)
        assert np.linalg.eigvalsh(reduced.mass).min() > 0.0
        power = 0.5 * v @ central(lambda q, d=dynamics: d(q, v).mass, at, v) @ v
        assert v @ reduced.bias == pytest.approx(power, rel=1e-5, abs=1e-7)


@every_mechanism
@given(parts, speeds)
@everywhere
def test_virtual_work(name: str, part: tuple[float, float], v: np.ndarray) -> None:
    """tau_s = J^T tau_p for inertia, velocity and gravity torques alike (paper, Eqs. 4 and 18)."""
    mechanism, joints = chain(name), joints_at(name, part)
    jacobian, rate = mechanism.jacobian(joints), mechanism.jacobian_bias(joints, v)
    drives = mechanism.reduced_dynamics(mechanism.drive_position(joints), jacobian @ v)
    serial = mechanism.serial_dynamics(joints, v)
    np.testing.assert_allclose(serial.mass, jacobian.T @ drives.mass @ jacobian, rtol=1e-9, atol=1e-14)
    np.testing.assert_allclose(serial.bias, jacobian.T @ (drives.bias + drives.mass @ rate), atol=1e-9)
    np.testing.assert_allclose(serial.gravity, jacobian.T @ drives.gravity, atol=1e-11)


@every_mechanism
@given(parts)
@everywhere
def test_gravity_is_the_slope_of_potential_energy(name: str, part: tuple[float, float]) -> None:
    mechanism, rest = chain(name), np.zeros(2)
    drives = mechanism.drive_position(joints_at(name, part))
    slope = [central(lambda q: mechanism.energy(q, rest), drives, e, 1e-4) for e in np.eye(2)]
    np.testing.assert_allclose(mechanism.reduced_dynamics(drives, rest).gravity, -np.array(slope), atol=1e-6)


@pytest.mark.parametrize("name", NAMES[1:])
def test_a_model_file_holds_j_at_the_start_posture(name: str) -> None:
    model, found = read_model(name), constant_transmission(chain(name))
    assert model.posture_dependent
    assert not found.constant
    assert found.deviation > 0.2
    np.testing.assert_allclose(model.transmission, found.matrix, atol=1e-6)


def test_four_loops_on_one_trunk_do_not_know_each_other() -> None:
    """A base that floats in the file is held; straight legs come out as parallelograms."""
    four, one = ClosedChain(quadruped()), chain("leg")
    assert four.size == 8
    np.testing.assert_allclose(
        constant_transmission(four, 5).matrix, np.kron(np.eye(4), [[1, 0], [1, 1]]), atol=1e-12
    )
    q, v = np.array([-0.4, 0.7]), np.array([2.0, -3.0])
    whole, leg = four.reduced_dynamics(np.tile(q, 4), np.tile(v, 4)), one.reduced_dynamics(q, v)
    np.testing.assert_allclose(whole.mass, np.kron(np.eye(4), leg.mass), atol=1e-14)
    np.testing.assert_allclose(whole.bias, np.tile(leg.bias, 4), atol=1e-13)
    np.testing.assert_allclose(whole.gravity, np.tile(leg.gravity, 4), atol=1e-13)
