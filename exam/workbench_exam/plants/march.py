"""The loop and the machine in time: Runge-Kutta steps, friction that sticks, rows as a log has them.

Friction is solved for together on all drives each step, as impulses within their bounds that leave stuck
drives at no speed at all (J. J. Moreau's time stepping; projected Gauss-Seidel). What it was in the step
before is in the Runge-Kutta step, so that sliding friction, which does not change, keeps that method's order.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .chain import GRAVITY
from .dynamics import factor, inertias, needed, solve

STEP = 5e-4  # s, at most
#: What a machine has that no catalogue lists; rows of a table: which, drive, three numbers, other joint.
PATCH, FOLLOWER, TONE, CUBIC = 0, 1, 2, 3


@njit(cache=True, error_model="numpy")
def strange(t, q, th, strangers, torque, limit):
    """Adds what the strangers push to `torque`, and what they rub to the friction's `limit`."""
    for s in strangers:
        i = int(s[1])
        if s[0] == PATCH:
            limit[i] += s[2] * np.exp(-(((th[i] - s[3]) / s[4]) ** 2))
        elif s[0] == FOLLOWER:
            torque[i] += s[2] * np.sin(q[int(s[5])] - s[3])
        elif s[0] == TONE:
            torque[i] += s[2] * np.sin(2 * np.pi * s[3] * t + s[4])
        else:
            torque[i] -= s[2] * (th[i] - s[3]) ** 3


@njit(cache=True, error_model="numpy")
def turn_with(q, w, th, om, d):
    """Angles and speeds of rigid drives are those of the joints."""
    n = len(q)
    for i in range(n):
        if d.stiffness[i] == 0.0:
            th[i], om[i] = 0.0, 0.0
            for k in range(n):
                th[i] += d.couple[i, k] * q[k]
                om[i] += d.couple[i, k] * w[k]


@njit(cache=True, error_model="numpy")
def mass(q, m, d):
    """Cholesky's factor of the mass matrix, rigid drives' rotors included."""
    full, n = inertias(q, m), len(q)
    for i in range(n):
        if d.stiffness[i] == 0.0:
            for j in range(n):
                for k in range(n):
                    full[j, k] += d.armature[i] * d.couple[i, j] * d.couple[i, k]
    factor(full)
    return full


@njit(cache=True, error_model="numpy")
def pushed(t, q, w, th, om, torque, m, d, strangers, a, al):
    """Accelerations of joints `a` and of rotors behind soft couplings `al`, under torques of the drives."""
    n = len(q)
    turn_with(q, w, th, om, d)
    total, bias = torque.copy(), np.zeros(n)
    strange(t, q, th, strangers, total, np.zeros(n))
    needed(q, w, np.zeros(n), GRAVITY, m, bias)
    a[:] = -bias
    for i in range(n):
        f = (
            total[i]
            - d.damping[i] * om[i]
            - d.drag[i] * om[i] * abs(om[i])
            - d.spring[i] * (th[i] - d.rest[i])
        )
        f += d.ripple[i] * np.sin(d.order[i] * th[i] + d.phase[i])
        if d.stiffness[i] > 0.0:
            wind, half = th[i] - q[i], 0.5 * d.gap[i]
            bent = wind - min(max(wind, -half), half)
            through = 0.0
            if half == 0.0 or bent != 0.0:
                through = d.stiffness[i] * bent + d.series[i] * (om[i] - w[i])
            a[i] += through
            al[i] = (f - through) / d.armature[i]
        else:
            al[i] = 0.0
            for k in range(n):
                a[k] += d.couple[i, k] * f
    solve(mass(q, m, d), a)


@njit(cache=True, error_model="numpy")
def step(t, h, q, w, th, om, torque, rub, m, d, strangers):
    """One step in place: angles `q`, speeds `w`, those of drives, and friction `rub` of this step."""
    n = len(q)
    total = torque + rub
    a, al = np.zeros((4, n)), np.zeros((4, n))
    ws, oms = np.zeros((4, n)), np.zeros((4, n))
    ws[0], oms[0] = w, om
    pushed(t, q, w, th, om, total, m, d, strangers, a[0], al[0])
    for s in range(1, 4):
        f = h if s == 3 else 0.5 * h
        ws[s], oms[s] = w + f * a[s - 1], om + f * al[s - 1]
        q2, th2, om2 = q + f * ws[s - 1], th + f * oms[s - 1], oms[s].copy()
        pushed(t + f, q2, ws[s], th2, om2, total, m, d, strangers, a[s], al[s])
    q += h / 6.0 * (ws[0] + 2.0 * (ws[1] + ws[2]) + ws[3])
    w += h / 6.0 * (a[0] + 2.0 * (a[1] + a[2]) + a[3])
    th += h / 6.0 * (oms[0] + 2.0 * (oms[1] + oms[2]) + oms[3])
    om += h / 6.0 * (al[0] + 2.0 * (al[1] + al[2]) + al[3])
    turn_with(q, w, th, om, d)
    limit = d.friction.copy()
    for i in range(n):
        if d.static[i] != 0.0:
            limit[i] += d.static[i] * np.exp(-((om[i] / d.slow[i]) ** 2))
    strange(t + h, q, th, strangers, np.zeros(n), limit)
    if not limit.any():
        return
    # what a unit of friction on each drive gives to the speeds of joints (a row each) and of all drives
    lower, give, seen = mass(q, m, d), np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        if d.stiffness[i] > 0.0:
            seen[i, i] = h / d.armature[i]
            continue
        give[i] = d.couple[i]
        solve(lower, give[i])
        for j in range(n):
            if d.stiffness[j] == 0.0:
                for k in range(n):
                    seen[i, j] += h * d.couple[j, k] * give[i, k]
    w_before, om_before, moved_any = w.copy(), om.copy(), False
    for _ in range(200):
        moved = 0.0
        for i in range(n):
            wanted = min(max(rub[i] - om[i] / seen[i, i], -limit[i]), limit[i])
            change = wanted - rub[i]
            if change == 0.0:
                continue
            rub[i], moved_any = wanted, True
            for j in range(n):
                om[j] += seen[i, j] * change
                w[j] += h * give[i, j] * change
            moved = max(moved, abs(change))
        if moved < 1e-10:
            break
    for i in range(n):  # exactly, where a drive is all that its joint turns with
        if abs(rub[i]) < limit[i]:
            if d.stiffness[i] > 0.0:
                om[i] = 0.0
            elif d.couple[i, i] == 1.0 and np.abs(d.couple[i]).sum() == 1.0:
                w[i] = 0.0
    if moved_any:
        q += 0.5 * h * (w - w_before)
        th += 0.5 * h * (om - om_before)
    turn_with(q, w, th, om, d)


@njit(cache=True, error_model="numpy")
def run(reference, per_tick, tick, kp, kd, noise, encoder, m, d, strangers, settle):
    """Ticks of the loop (N, 5 n): angles and speeds as read, torques, commands, true angles; of drives.

    Args:
        reference: of each tick (N, n); the machine begins at rest there, and holds it for `settle` ticks.
        per_tick: steps a tick; `tick` [s].
        kp, kd: (n,). `noise`: of the speeds read (N, n). `encoder`: steps of the angles read (n,), or 0.
        m: the links. `d`: the drives. `strangers`: rows of `strange`.
    """
    rows, n = reference.shape
    shown = np.zeros((rows, 5 * n))
    lower = d.couple.copy()
    q = np.linalg.solve(lower, reference[0])
    w, rub, th, om = np.zeros(n), np.zeros(n), reference[0].copy(), np.zeros(n)
    now, push, seen = np.zeros(n), np.zeros(n), np.zeros(n)
    h = tick / per_tick
    late = int(np.rint(d.delay[0] / h))
    ticks_late = (late + per_tick - 1) // per_tick
    asked = np.zeros((ticks_late + 1, n))  # the latest commands, a ring
    for row in range(-settle, rows):
        k = max(row, 0)
        ring = (row + settle) % (ticks_late + 1)
        for i in range(n):
            angle = th[i] + d.offset[i]
            seen[i] = np.rint(angle / encoder[i]) * encoder[i] if encoder[i] > 0.0 else angle
            speed = om[i] + noise[k, i] * (row >= 0)
            asked[ring, i] = d.driven[i] * (kp[i] * (reference[k, i] - seen[i]) - kd[i] * speed)
            if row >= 0:
                shown[row, i], shown[row, n + i], shown[row, 3 * n + i] = seen[i], speed, asked[ring, i]
                shown[row, 4 * n + i] = th[i]
        for p in range(per_tick):
            back = (late - p + per_tick - 1) // per_tick if late > p else 0
            for i in range(n):
                goal = asked[(row + settle - back) % (ticks_late + 1), i]
                goal = min(max(goal, -d.limit[i]), d.limit[i])
                if d.lag[i] > 0.0:
                    if p == 0 and row >= 0:
                        shown[row, 2 * n + i] = now[i]
                    kept = np.exp(-h / d.lag[i])
                    mean = goal + (now[i] - goal) * (1.0 - kept) * d.lag[i] / h
                    now[i] = goal + (now[i] - goal) * kept
                else:
                    mean = goal
                    now[i] = goal
                    if p == 0 and row >= 0:
                        shown[row, 2 * n + i] = goal
                push[i] = d.gain[i] * mean + d.bias[i]
            step(row * tick + p * h, h, q, w, th, om, push, rub, m, d, strangers)
        if not np.abs(w).sum() + np.abs(om).sum() < 1e3:
            shown[max(row, 0) :] = np.nan
            break
    return shown
