"""The loop and the machine in time: Runge-Kutta steps, friction that sticks, rows as a log has them.

Friction is solved for together on all axes each step, as impulses within their bounds that leave stuck axes
at no speed at all (J. J. Moreau's time stepping; projected Gauss-Seidel). What it was in the step before is
in the Runge-Kutta step, so that sliding friction, which does not change, keeps that method's order.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .chain import GRAVITY
from .dynamics import acceleration, inertias

STEP = 2e-4  # s, at most
#: What a machine has that no catalogue lists; rows of a table: which, axis, three numbers, other axis.
PATCH, FOLLOWER, TONE = 0, 1, 2


@njit(cache=True, error_model="numpy")
def strange(t, q, w, strangers, torque, limit):
    """Adds what the strangers push to `torque`, and what they rub to the friction's `limit`."""
    for s in strangers:
        i = int(s[1])
        if s[0] == PATCH:
            limit[i] += s[2] * np.exp(-(((q[i] - s[3]) / s[4]) ** 2))
        elif s[0] == FOLLOWER:
            torque[i] += s[2] * np.sin(q[int(s[5])] - s[3])
        else:
            torque[i] += s[2] * np.sin(2 * np.pi * s[3] * t + s[4])


@njit(cache=True, error_model="numpy")
def pushed(t, q, w, torque, m, strangers, spare):
    """Accelerations with the strangers' torques."""
    total = torque.copy()
    strange(t, q, w, strangers, total, spare)
    return acceleration(q, w, total, GRAVITY, m)


@njit(cache=True, error_model="numpy")
def step(t, h, q, w, torque, rub, m, strangers):
    """One step in place: angles `q`, speeds `w`, and the friction torques `rub` of this step."""
    n = len(q)
    spare = np.zeros(n)
    total = torque + rub
    a1 = pushed(t, q, w, total, m, strangers, spare)
    w2 = w + 0.5 * h * a1
    a2 = pushed(t + 0.5 * h, q + 0.5 * h * w, w2, total, m, strangers, spare)
    w3 = w + 0.5 * h * a2
    a3 = pushed(t + 0.5 * h, q + 0.5 * h * w2, w3, total, m, strangers, spare)
    w4 = w + h * a3
    a4 = pushed(t + h, q + h * w3, w4, total, m, strangers, spare)
    q += h / 6.0 * (w + 2.0 * (w2 + w3) + w4)
    w += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
    limit = m.friction.copy()
    strange(t + h, q, w, strangers, np.zeros(n), limit)
    if not limit.any():
        return
    give = np.linalg.inv(inertias(q, m))
    before = w.copy()
    kept = rub.copy()
    for _ in range(200):
        moved = 0.0
        for i in range(n):
            wanted = min(max(rub[i] - w[i] / (h * give[i, i]), -limit[i]), limit[i])
            change = wanted - rub[i]
            rub[i] = wanted
            for j in range(n):
                w[j] += h * give[j, i] * change
            moved = max(moved, abs(change))
        if moved < 1e-10:
            break
    for i in range(n):
        if abs(rub[i]) < limit[i]:
            w[i] = 0.0
    if not np.array_equal(kept, rub):
        q += 0.5 * h * (w - before)


@njit(cache=True, error_model="numpy")
def run(start, reference, per_tick, tick, kp, kd, noise, encoder, driven, m, strangers, settle):
    """Ticks of the loop (N, 4 n): angles and speeds as the loop reads them, torques, and true angles.

    Args:
        start: angles (n,), at rest.
        reference: of each tick (N, n); the first is held for `settle` ticks before the first row.
        per_tick: steps a tick; `tick` [s].
        kp, kd: (n,). `noise`: of the speeds read (N, n). `encoder`: steps of the angles read (n,), or 0.
        driven: (n,) 1 where a motor is.
        m: the links. `strangers`: rows of `strange`.
    """
    rows, n = reference.shape
    shown = np.zeros((rows, 4 * n))
    q, w, rub = start.copy(), np.zeros(n), np.zeros(n)
    torque, seen = np.zeros(n), np.zeros(n)
    for row in range(-settle, rows):
        k = max(row, 0)
        for i in range(n):
            seen[i] = np.rint(q[i] / encoder[i]) * encoder[i] if encoder[i] > 0.0 else q[i]
            speed = w[i] + noise[k, i] * (row >= 0)
            torque[i] = driven[i] * (kp[i] * (reference[k, i] - seen[i]) - kd[i] * speed)
            if row >= 0:
                shown[row, i], shown[row, n + i], shown[row, 2 * n + i] = seen[i], speed, torque[i]
                shown[row, 3 * n + i] = q[i]
        for p in range(per_tick):
            step(row * tick + p * tick / per_tick, tick / per_tick, q, w, torque, rub, m, strangers)
        if not np.abs(w).sum() < 1e3:
            shown[max(row, 0) :] = np.nan
            break
    return shown
