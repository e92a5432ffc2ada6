"""Drive positions as polynomials: J is their slope, and joints come back from drives, beyond the box too."""

import numpy as np
import torch

from workbench.core import DriveMap

_MAP = DriveMap(
    np.array([0.1, -0.2]),
    np.array([0.5, 0.4]),
    np.array([[0, 0], [1, 0], [0, 1], [2, 1], [0, 3]]),
    np.array([[0.1, 1.0, 0.2, 0.05, 0.03], [0.3, -0.2, 0.9, 0.02, 0.01]]),
)
_Q = np.array([[0.2, 0.1], [-0.1, -0.4], [0.9, 0.5]])  # the last one lies outside


def test_the_jacobian_is_the_slope_of_the_drives() -> None:
    small = 1e-6 * np.eye(2)
    ways = [(_MAP.drives(_Q + d) - _MAP.drives(_Q - d)) / 2e-6 for d in small]
    np.testing.assert_allclose(_MAP.jacobian(_Q), np.stack(ways, axis=-1), atol=1e-8)


def test_joints_come_back_from_drives_and_power_stays() -> None:
    np.testing.assert_allclose(_MAP.joints(_MAP.drives(_Q)), _Q, atol=1e-9)
    torque, rate = np.array([[1.0, -2.0]] * 3), np.array([[0.3, 0.7]] * 3)
    drives = np.einsum("bij,bj->bi", _MAP.jacobian(_Q), rate)
    np.testing.assert_allclose(_MAP.joint_speed(_Q, drives), rate, atol=1e-12)
    power = np.sum(_MAP.drive_torque(_Q, torque) * drives, axis=1)
    np.testing.assert_allclose(power, np.sum(torque * rate, axis=1), atol=1e-12)


def test_torch_says_the_same_and_so_does_its_table() -> None:
    torque = np.ones((3, 2))
    there = _MAP.drive_torque(torch.tensor(_Q), torch.tensor(torque), torch)
    np.testing.assert_allclose(there.numpy(), _MAP.drive_torque(_Q, torque), atol=1e-12)
    np.testing.assert_array_equal(DriveMap.of(_MAP.table()).drives(_Q), _MAP.drives(_Q))
