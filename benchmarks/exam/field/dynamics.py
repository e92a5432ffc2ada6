"""Equations of motion of a row of links by recursive Newton-Euler, in the links' own frames.

J. Y. S. Luh, M. W. Walker and R. P. C. Paul, On-line computational scheme for mechanical manipulators, 1980.
"""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, error_model="numpy")
def cross(a, b, out):
    """out = a x b."""
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    out[0], out[1], out[2] = x, y, z


@njit(cache=True, error_model="numpy")
def turned(axis, angle, out):
    """out = the rotation about a unit axis (3, 3): from the link's frame to that of the link before."""
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = axis[0], axis[1], axis[2]
    d = 1.0 - c
    out[0, 0], out[0, 1], out[0, 2] = c + x * x * d, x * y * d - z * s, x * z * d + y * s
    out[1, 0], out[1, 1], out[1, 2] = y * x * d + z * s, c + y * y * d, y * z * d - x * s
    out[2, 0], out[2, 1], out[2, 2] = z * x * d - y * s, z * y * d + x * s, c + z * z * d


@njit(cache=True, error_model="numpy")
def needed(q, w, a, gravity, m, out):
    """Joint torques of a motion of the rigid links and rotors (n,); friction and damping are not in it."""
    n = len(q)
    rot, arm = np.zeros((n, 3, 3)), np.zeros((n, 3))
    force, moment = np.zeros((n, 3)), np.zeros((n, 3))
    spin, swing, lift = np.zeros(3), np.zeros(3), np.zeros(3)
    lift[2] = gravity
    t1, t2, t3 = np.zeros(3), np.zeros(3), np.zeros(3)
    for i in range(n):
        turned(m.axis[i], 0.0 if m.slides[i] else q[i], rot[i])
        for k in range(3):
            arm[i, k] = m.offset[i, k] + (m.axis[i, k] * q[i] if m.slides[i] else 0.0)
        cross(swing, arm[i], t1)
        cross(spin, arm[i], t2)
        cross(spin, t2, t3)
        for k in range(3):
            t1[k] += lift[k] + t3[k]
        for k in range(3):
            lift[k] = rot[i, 0, k] * t1[0] + rot[i, 1, k] * t1[1] + rot[i, 2, k] * t1[2]
            t2[k] = rot[i, 0, k] * spin[0] + rot[i, 1, k] * spin[1] + rot[i, 2, k] * spin[2]
            t3[k] = rot[i, 0, k] * swing[0] + rot[i, 1, k] * swing[1] + rot[i, 2, k] * swing[2]
        spin[:], swing[:] = t2, t3
        cross(spin, m.axis[i], t1)
        for k in range(3):
            if m.slides[i]:
                lift[k] += 2.0 * t1[k] * w[i] + m.axis[i, k] * a[i]
            else:
                swing[k] += t1[k] * w[i] + m.axis[i, k] * a[i]
                spin[k] += m.axis[i, k] * w[i]
        cross(swing, m.centre[i], t1)
        cross(spin, m.centre[i], t2)
        cross(spin, t2, t3)
        for k in range(3):
            force[i, k] = m.mass[i] * (lift[k] + t1[k] + t3[k])
            t2[k] = m.inertia[i, k] * spin[k]
        cross(spin, t2, t1)
        cross(m.centre[i], force[i], t2)
        for k in range(3):
            moment[i, k] = m.inertia[i, k] * swing[k] + t1[k] + t2[k]
    for i in range(n - 1, -1, -1):
        out[i] = m.armature[i] * a[i]
        for k in range(3):
            out[i] += m.axis[i, k] * (force[i, k] if m.slides[i] else moment[i, k])
        if i > 0:
            for k in range(3):
                t1[k] = rot[i, k, 0] * force[i, 0] + rot[i, k, 1] * force[i, 1] + rot[i, k, 2] * force[i, 2]
                t2[k] = (
                    rot[i, k, 0] * moment[i, 0] + rot[i, k, 1] * moment[i, 1] + rot[i, k, 2] * moment[i, 2]
                )
            cross(arm[i], t1, t3)
            for k in range(3):
                force[i - 1, k] += t1[k]
                moment[i - 1, k] += t2[k] + t3[k]


@njit(cache=True, error_model="numpy")
def inertias(q, m):
    """Mass matrix (n, n), rotors included."""
    n = len(q)
    full, still, unit, column = np.zeros((n, n)), np.zeros(n), np.zeros(n), np.zeros(n)
    for i in range(n):
        unit[:] = 0.0
        unit[i] = 1.0
        needed(q, still, unit, 0.0, m, column)
        full[:, i] = column
    return full


@njit(cache=True, error_model="numpy")
def acceleration(q, w, torque, gravity, m):
    """Joint accelerations (n,) under joint torques, viscous damping included."""
    n = len(q)
    bias = np.zeros(n)
    needed(q, w, np.zeros(n), gravity, m, bias)
    return np.linalg.solve(inertias(q, m), torque - m.damping * w - bias)


def energy(q: np.ndarray, w: np.ndarray, gravity: float, m) -> float:
    """Kinetic and potential energy [J], of places and speeds of the links and not of the equations above."""
    rotation, place, total = np.eye(3), np.zeros(3), 0.0
    spin, speed = np.zeros(3), np.zeros(3)  # in the world's frame
    for i in range(len(q)):
        axis = rotation @ m.axis[i]
        arm = rotation @ (m.offset[i] + (m.axis[i] * q[i] if m.slides[i] else 0.0))
        place, speed = place + arm, speed + np.cross(spin, arm)
        if m.slides[i]:
            speed = speed + axis * w[i]
        else:
            turn = np.zeros((3, 3))
            turned(m.axis[i], q[i], turn)
            rotation, spin = rotation @ turn, spin + axis * w[i]
        lever = rotation @ m.centre[i]
        at_centre, own = speed + np.cross(spin, lever), rotation.T @ spin
        total += 0.5 * m.mass[i] * at_centre @ at_centre + 0.5 * own @ (m.inertia[i] * own)
        total += 0.5 * m.armature[i] * w[i] ** 2 + m.mass[i] * gravity * (place + lever)[2]
    return float(total)
