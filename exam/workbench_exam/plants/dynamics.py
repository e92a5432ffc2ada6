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
    """Mass matrix (n, n), joints' armature included: sums over links of their Jacobians' squares."""
    n = len(q)
    full, turn, rot, old = np.zeros((n, n)), np.zeros((3, 3)), np.eye(3), np.eye(3)
    axes, places, here = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(3)
    fast, spin, lever, t = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(3), np.zeros(3)
    for i in range(n):
        for k in range(3):
            for j in range(3):
                here[k] += rot[k, j] * (m.offset[i, j] + (m.axis[i, j] * q[i] if m.slides[i] else 0.0))
        turned(m.axis[i], 0.0 if m.slides[i] else q[i], turn)
        old[:] = rot
        for k in range(3):
            places[i, k], axes[i, k], lever[k] = here[k], 0.0, 0.0
            for j in range(3):
                axes[i, k] += old[k, j] * m.axis[i, j]
                rot[k, j] = old[k, 0] * turn[0, j] + old[k, 1] * turn[1, j] + old[k, 2] * turn[2, j]
        for k in range(3):
            for j in range(3):
                lever[k] += rot[k, j] * m.centre[i, j]
        for j in range(i + 1):
            if m.slides[j]:
                fast[j], spin[j] = axes[j], 0.0
                continue
            for k in range(3):
                t[k] = here[k] + lever[k] - places[j, k]
                spin[j, k] = (
                    rot[0, k] * axes[j, 0] + rot[1, k] * axes[j, 1] + rot[2, k] * axes[j, 2]
                )  # in the link's frame
            cross(axes[j], t, fast[j])
        for j in range(i + 1):
            for k in range(j + 1):
                for c in range(3):
                    full[j, k] += (
                        m.mass[i] * fast[j, c] * fast[k, c] + m.inertia[i, c] * spin[j, c] * spin[k, c]
                    )
        full[i, i] += m.armature[i]
    for j in range(n):
        for k in range(j):
            full[k, j] = full[j, k]
    return full


@njit(cache=True, error_model="numpy")
def factor(full):
    """Cholesky's lower factor of a mass matrix, in place: the same on every machine, as no library's is."""
    n = len(full)
    for j in range(n):
        for k in range(j):
            full[j, j] -= full[j, k] * full[j, k]
        full[j, j] = np.sqrt(full[j, j])
        for i in range(j + 1, n):
            for k in range(j):
                full[i, j] -= full[i, k] * full[j, k]
            full[i, j] /= full[j, j]


@njit(cache=True, error_model="numpy")
def solve(lower, x):
    """x = the accelerations (n,) under the torques `x`, in place; `lower` is of `factor`."""
    n = len(x)
    for i in range(n):
        for k in range(i):
            x[i] -= lower[i, k] * x[k]
        x[i] /= lower[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= lower[k, i] * x[k]
        x[i] /= lower[i, i]
