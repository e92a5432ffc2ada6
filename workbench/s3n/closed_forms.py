"""The paper's equations of S3N as plain functions: serial coordinates q_s, actuator coordinates q_p = J q_s.

Matrices are (..., 2, 2) over arrays of the knee angle alpha = q2_p - q1_p = q2_s [rad] (paper, Eq. 3);
inertia in kg m^2, damping in N m s/rad. Equations have the numbers that the typeset paper gives them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

#: J of the parallelogram (paper, Eq. 2).
JACOBIAN = np.array([[1.0, 0.0], [1.0, 1.0]])


def reflected(gear: ArrayLike, rotor: ArrayLike) -> np.ndarray:
    """N^2 times a rotor's inertia or damping: what it is at the drive's output (paper, Eq. 7)."""
    return np.asarray(gear, float) ** 2 * np.asarray(rotor, float)


def to_serial(parallel: np.ndarray, j: np.ndarray = JACOBIAN) -> np.ndarray:
    """J^T X J: inertia or damping of actuator coordinates in serial ones (paper, Eqs. 9, 10 and 16)."""
    return j.T @ parallel @ j


def pulled_back(drives: ArrayLike, j: np.ndarray = JACOBIAN) -> np.ndarray:
    """J^T diag(x_i) J of the drives' inertia or damping x (n,) (paper, Eqs. 8 to 10)."""
    return to_serial(np.diag(np.asarray(drives, float)), j)


def actuator_increment(drives: ArrayLike, j: np.ndarray = JACOBIAN) -> np.ndarray:
    """Delta M_act or Delta D_act: pulled back, less the same on the serial joints (paper, Eqs. 12 and 13)."""
    return pulled_back(drives, j) - np.diag(np.asarray(drives, float))


def parallel_inertia(m11: float, m12: float, m22: float, alpha: np.ndarray | float) -> np.ndarray:
    """M_p(alpha) = [[M11, M12 cos alpha], [., M22]] (paper, Eq. 14)."""
    alpha = np.asarray(alpha, float)
    out = np.empty((*alpha.shape, 2, 2))
    out[..., 0, 0], out[..., 1, 1] = m11, m22
    out[..., 0, 1] = out[..., 1, 0] = m12 * np.cos(alpha)
    return out


def parallelogram_form(
    mass: np.ndarray, pull: np.ndarray, q: np.ndarray, j: np.ndarray = JACOBIAN
) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Return (M11, M12, M22) [kg m^2] of Eq. 14 and (g1, g2) [N m] of weights -g sin q_p, nearest to terms.

    Args:
        mass, pull: inertia (N, 2, 2) and torque of the weights (N, 2), actuator coordinates.
        q: serial positions (N, 2) [rad], from straight down.

    Returns:
        Them, and how far the terms are from that form: largest deviation of inertia and of torque.
    """
    cosine, sine = np.cos(q[:, 1]), np.sin(q @ j.T)
    m = np.array([mass[:, 0, 0].mean(), mass[:, 0, 1] @ cosine / (cosine @ cosine), mass[:, 1, 1].mean()])
    g = -np.sum(pull * sine, axis=0) / np.sum(sine**2, axis=0)
    off = np.abs(parallel_inertia(m[0], m[1], m[2], q[:, 1]) - mass).max()
    return m, g, off, np.abs(pull + g * sine).max()


def link_inertia(total: np.ndarray, drives: ArrayLike) -> np.ndarray:
    """M_link^p = M_p - diag(J_i): the links alone, actuator coordinates (paper, Eq. 15)."""
    return total - np.diag(np.asarray(drives, float))


def serial_inertia(links: np.ndarray, drives: ArrayLike) -> np.ndarray:
    """M_s = M_link^s + diag(J_i): the serial tree the Kin-Only way (paper, Eq. 17)."""
    return links + np.diag(np.asarray(drives, float))


def residual_from_links(parallel_links: np.ndarray, serial_links: np.ndarray) -> np.ndarray:
    """Delta M_link = J^T M_link^p J - M_link^s (paper, Eq. 19, first line)."""
    return to_serial(parallel_links) - serial_links


def residual_from_total(total: np.ndarray, actuator_normalised: np.ndarray) -> np.ndarray:
    """Delta M_link = J^T M_p J - (M_s + Delta M_act) (paper, Eqs. 18 and 19, second line)."""
    return to_serial(total) - actuator_normalised


def normalised(serial: np.ndarray, *increments: np.ndarray) -> np.ndarray:
    """M_norm = M_s + Delta M_act + Delta M_link, and D_norm alike (paper, Eqs. 20 and 21)."""
    return sum(increments, np.asarray(serial, float))


def residual_velocity_torque(m12: float, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Velocity terms of Delta M_link that the paper neglects before Eq. 22, (..., 2) [N m], bias side.

    M12 sin(alpha) (-w2^2, w1^2) in actuator coordinates, from the kinetic energy M12 cos(alpha) w1 w2 by
    Lagrange, pulled back.

    Args:
        m12: the increment's M12 [kg m^2].
        position: q_s, (..., 2) [rad].
        velocity: rate of q_s, (..., 2) [rad/s].
    """
    w = velocity @ JACOBIAN.T
    size = m12 * np.sin(position[..., 1])
    return np.stack([-size * w[..., 1] ** 2, size * w[..., 0] ** 2], axis=-1) @ JACOBIAN


def injection_radius(implicit: np.ndarray, injected: np.ndarray) -> np.ndarray:
    """Spectral radius of qdd_k = -(implicit^-1 injected) qdd_(k-1), (...,).

    What the torques of the preceding step do to the acceleration of the next (paper, Eqs. 25 to 27): below
    one an error dies out, ringing at the sample rate; from one on it grows, however short the step.
    """
    return np.abs(np.linalg.eigvals(np.linalg.solve(implicit, injected))).max(axis=-1)
