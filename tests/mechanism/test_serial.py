"""Serial coordinates of a closed chain: positions there and back, J and its rate, virtual work."""

import numpy as np
import pytest

from workbench.core import Mechanism, SimulationError
from workbench.core.paths import closed_chain_file
from workbench.mechanism import ClosedChain, constant_transmission

LIMITS = ((-1.6, 1.6), (0.35, 2.6))
STATES = [
    (np.array([-0.55, np.pi / 3]), np.array([2.0, -3.0])),
    (np.array([0.9, 2.1]), np.array([-5.0, 8.0])),
]


@pytest.fixture(scope="module")
def leg() -> ClosedChain:
    return ClosedChain(Mechanism(closed_chain_file("leg"), limits=LIMITS))


def test_a_parallelogram_has_the_papers_transmission(leg: ClosedChain) -> None:
    found = constant_transmission(leg)
    assert found.constant
    assert found.deviation < 1e-12
    np.testing.assert_array_equal(found.matrix, [[1.0, 0.0], [1.0, 1.0]])


def test_assembly_of_the_straight_leg_goes_inside_the_limits(leg: ClosedChain) -> None:
    """At zero the leg is straight, a dead point from which a folded linkage goes on as well."""
    assert all(low < x < high for x, (low, high) in zip(leg.start[1], LIMITS, strict=True))
    narrow = ClosedChain(Mechanism(closed_chain_file("leg"), limits=((-1.6, 1.6), (1.4, 2.6))))
    np.testing.assert_allclose(narrow.start[1], [0.0, 2.0], atol=1e-12)


@pytest.mark.parametrize(("joints", "_speeds"), STATES)
def test_positions_there_and_back(leg: ClosedChain, joints: np.ndarray, _speeds: np.ndarray) -> None:
    drives = leg.drive_position(joints)
    np.testing.assert_allclose(drives, [joints[0], joints.sum()], atol=1e-13)
    np.testing.assert_allclose(leg.serial_slope(drives)[0], joints, atol=1e-13)


@pytest.mark.parametrize(("joints", "speeds"), STATES)
def test_serial_dynamics_are_the_pulled_back_ones(
    leg: ClosedChain, joints: np.ndarray, speeds: np.ndarray
) -> None:
    """M_s = J^T M_p J, and the bias carries J' (paper, Eq. 18)."""
    jacobian, rate = leg.jacobian(joints), leg.jacobian_bias(joints, speeds)
    drives = leg.reduced_dynamics(leg.drive_position(joints), jacobian @ speeds)
    serial = leg.serial_dynamics(joints, speeds)
    np.testing.assert_allclose(serial.mass, jacobian.T @ drives.mass @ jacobian, atol=1e-14)
    np.testing.assert_allclose(serial.bias, jacobian.T @ (drives.bias + drives.mass @ rate), atol=1e-12)
    np.testing.assert_allclose(serial.gravity, jacobian.T @ drives.gravity, atol=1e-13)


def test_the_foot_is_where_the_two_links_put_it(leg: ClosedChain) -> None:
    hip, knee = STATES[0][0]
    expected = [0.175 * np.sin(hip) + 0.24 * np.sin(hip + knee), 0.0]
    expected += [-0.175 * np.cos(hip) - 0.24 * np.cos(hip + knee)]
    np.testing.assert_allclose(leg.foot_position(STATES[0][0]), expected, atol=1e-14)
    h = 1e-6
    columns = [
        (leg.foot_position(STATES[0][0] + h * e) - leg.foot_position(STATES[0][0] - h * e)) / (2 * h)
        for e in np.eye(2)
    ]
    np.testing.assert_allclose(leg.foot_jacobian(STATES[0][0]), np.transpose(columns), atol=1e-9)


def test_a_dead_point_in_serial_coordinates_is_refused(leg: ClosedChain) -> None:
    with pytest.raises(SimulationError, match=r"dead point at hip = 0.4, knee = 0"):
        leg.jacobian(np.array([0.4, 0.0]))
