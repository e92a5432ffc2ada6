"""Two mechanisms against equations written down by hand, without Drake and without the projection."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.mechanism import Reduced

from .chains import chain, joints_at

BASE, PROXIMAL, DISTAL = 0.04, 0.16, 0.26
#: Mass, distance of the centre of mass from the upper joint, inertia about it: proximal and distal, 1 and 2.
LINKS = (((0.35, 0.07, 0.0011), (0.16, 0.14, 0.0013)), ((0.35, 0.07, 0.0011), (0.12, 0.12, 0.0008)))

parts = st.tuples(*[st.floats(0.0, 1.0)] * 2)
speeds = st.tuples(*[st.floats(-5.0, 5.0)] * 2).map(np.array)
everywhere = settings(max_examples=15, deadline=None, derandomize=True)


def five_bar(q: np.ndarray, v: np.ndarray) -> Reduced:
    """The five-bar in its two drive angles: two double pendulums in absolute angles whose tips coincide.

    Tips at (+-BASE, 0) + PROXIMAL e(a_i) + DISTAL e(b_i), e(x) = (sin x, -cos x); a_i are the drives, and b_i
    follow from intersecting two circles. Scalar products of the closure, differentiated once and twice, with
    e(b_2) and e(b_1) leave one unknown each.
    """
    ends = [
        np.array([pin, 0]) + PROXIMAL * np.array([np.sin(x), -np.cos(x)])
        for pin, x in zip((BASE, -BASE), q, strict=True)
    ]
    way = ends[1] - ends[0]
    half = np.linalg.norm(way) / 2
    below = np.array([way[1], -way[0]]) / (2 * half)  # the tip is on the lower side
    tip = ends[0] + way / 2 + np.sqrt(DISTAL**2 - half**2) * (below if below[1] < 0 else -below)
    b = [float(np.arctan2(*((tip - end) * (1, -1)))) for end in ends]
    s = DISTAL * np.sin(b[1] - b[0])
    w = PROXIMAL / s * np.array([
        [-np.sin(b[1] - q[0]), np.sin(b[1] - q[1])],
        [-np.sin(b[0] - q[0]), np.sin(b[0] - q[1])],
    ])  # fmt: skip
    u = w @ v
    pull = [
        PROXIMAL * (np.cos(x - q[0]) * v[0] ** 2 - np.cos(x - q[1]) * v[1] ** 2)
        + DISTAL * (np.cos(x - b[0]) * u[0] ** 2 - np.cos(x - b[1]) * u[1] ** 2)
        for x in (b[1], b[0])
    ]
    turning = np.array(pull) / s
    mass, bias, gravity = np.zeros((2, 2)), np.zeros(2), np.zeros(2)
    for i, ((m1, c1, i1), (m2, c2, i2)) in enumerate(LINKS):
        project = np.vstack([np.eye(2)[i], w[i]])
        couple = m2 * PROXIMAL * c2
        inertia = np.array([
            [i1 + m1 * c1**2 + m2 * PROXIMAL**2, couple * np.cos(q[i] - b[i])],
            [couple * np.cos(q[i] - b[i]), i2 + m2 * c2**2],
        ])  # fmt: skip
        centrifugal = couple * np.sin(q[i] - b[i]) * np.array([u[i] ** 2, -(v[i] ** 2)])
        weight = -9.81 * np.array([(m1 * c1 + m2 * PROXIMAL) * np.sin(q[i]), m2 * c2 * np.sin(b[i])])
        mass += project.T @ inertia @ project
        bias += project.T @ (centrifugal + inertia @ np.array([0.0, turning[i]]))
        gravity += project.T @ weight
    return Reduced(mass, bias, gravity)


@given(parts, speeds)
@everywhere
def test_the_five_bar(part: tuple[float, float], v: np.ndarray) -> None:
    mechanism = chain("five_bar")
    q = mechanism.drive_position(joints_at("five_bar", part))
    found, expected = mechanism.reduced_dynamics(q, v), five_bar(q, v)
    np.testing.assert_allclose(found.mass, expected.mass, atol=1e-13)
    np.testing.assert_allclose(found.bias, expected.bias, atol=1e-11)
    np.testing.assert_allclose(found.gravity, expected.gravity, atol=1e-12)


def crank_angle(pitch: float, roll: float, side: float, rod: float) -> float:
    """Angle of the ankle's crank from the length of its rod: A cos q + B sin q = C."""
    heel = np.array([-0.07, side, 0.0])
    turn = np.array([[np.cos(pitch), 0, -np.sin(pitch)], [0, 1, 0], [np.sin(pitch), 0, np.cos(pitch)]])
    tilt = np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
    x, y, z = turn @ tilt @ heel - np.array([-0.02, side, rod])  # from the crank's pin to the heel
    a, b = 2 * 0.05 * x, 2 * 0.05 * z  # the crank's end is at -0.05 (cos q, 0, sin q)
    c = rod**2 - x**2 - y**2 - z**2 - 0.05**2
    return float(np.arctan2(b, a) + np.arccos(c / np.hypot(a, b)))


@pytest.mark.parametrize("pitch", [-0.5, -0.1, 0.4])
@pytest.mark.parametrize("roll", [-0.25, 0.1])
def test_the_ankles_push_rods(pitch: float, roll: float) -> None:
    expected = [crank_angle(pitch, roll, 0.035, 0.16), crank_angle(pitch, roll, -0.035, 0.24)]
    found = chain("ankle").drive_position(np.array([pitch, roll]))
    np.testing.assert_allclose(found, expected, atol=1e-12)
