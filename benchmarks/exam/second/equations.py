"""Hamilton's equations of the leg, and dry friction as impulses.

The state is angles q and momenta p of thigh, shank, motor 1, motor 2, then the Dahl states, the currents
and the filtered speeds. With the energies of `bodies`, p' = -dH/dq + torque; a motor without a spring
behind it is its link. Dry friction is a set-valued law of the speed at the end of the step, solved for
the impulse of the step (J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics,
1988): a pin that can be held is held exactly, without a band of speed and without locating when it
stops.
"""

from __future__ import annotations

from math import cos, exp, sin

import numpy as np
from numba import njit

# The state: q 0-3, p 4-7, Dahl z 8-11, currents 12-13, filtered speeds 14-15.
STATES = 16
# Rows of the table of drives, a column per motor.
ROTOR, DAMPING, LIMIT, STALL, NO_LOAD, LAG, GAIN, BIAS, STIFFNESS, SERIES, GAP, FILTER = range(12)
# Places: hip drive, knee drive, knee pin.
HIP, KNEE, PIN = range(3)
VISCOUS, QUADRATIC, SPRING, RIPPLE, CUBIC, STRAP, DETENT, CROSS = range(8)  # smooth torques
COULOMB, STRIBECK, UNEVEN, LOADED, PATCHY = range(5)  # dry ones
_SWEEPS, _TIGHT = 60, 1e-13


@njit(cache=True, error_model="numpy")
def speeds(x, links, drives, v):
    """Speeds (4,) of a state, into `v`: p = M(q) v."""
    soft1, soft2 = drives[STIFFNESS, 0] > 0.0, drives[STIFFNESS, 1] > 0.0
    m11 = links[0] if soft1 else links[0] + drives[ROTOR, 0]
    m22 = links[2] if soft2 else links[2] + drives[ROTOR, 1]
    m12 = links[1] * cos(x[1] - x[0])
    det = m11 * m22 - m12 * m12
    v[0] = (m22 * x[4] - m12 * x[5]) / det
    v[1] = (m11 * x[5] - m12 * x[4]) / det
    v[2] = x[6] / drives[ROTOR, 0] if soft1 else v[0]
    v[3] = x[7] / drives[ROTOR, 1] if soft2 else v[1]


@njit(cache=True, error_model="numpy")
def at_place(place, values):
    """Angle or speed at a place, of those of thigh, shank and motors (4,)."""
    if place == PIN:
        return values[1] - values[0]
    return values[2 + place]


@njit(cache=True, error_model="numpy")
def push(place, torque, drives, force):
    """Adds a torque at a place to the forces (4,) on thigh, shank and motors."""
    if place == PIN:
        force[1] += torque
        force[0] -= torque
    elif drives[STIFFNESS, place] > 0.0:
        force[2 + place] += torque
    else:
        force[place] += torque


@njit(cache=True, error_model="numpy")
def allowed(command, speed, drives, i):
    """What of a command [N m] a drive's limits let through."""
    torque = min(max(command, -drives[LIMIT, i]), drives[LIMIT, i])
    if drives[STALL, i] > 0.0:
        share = speed / drives[NO_LOAD, i]
        up = drives[STALL, i] * min(max(1.0 - share, 0.0), 1.0)
        down = drives[STALL, i] * min(max(1.0 + share, 0.0), 1.0)
        torque = min(max(torque, -down), up)
    return torque


@njit(cache=True, error_model="numpy")
def smooth_torque(row, q, v):
    """Torque of one smooth effect: kind, place, parameters; of angles and speeds (4,)."""
    kind, place = int(row[0]), int(row[1])
    at, w = at_place(place, q), at_place(place, v)
    if kind == VISCOUS:
        return -row[2] * w
    if kind == QUADRATIC:
        return -row[2] * w * abs(w)
    if kind == SPRING:
        return -row[2] * (at - row[3])
    if kind == RIPPLE:
        return row[2] * sin(row[3] * at + row[4])
    if kind == CUBIC:
        return -row[2] * (at - row[3]) ** 3
    if kind == STRAP:
        return -row[2] * max(at - row[3], 0.0)
    if kind == DETENT:
        far = (at - row[3]) / row[4]
        return -row[2] * 1.6487 * far * exp(-0.5 * far * far)  # its largest is row[2]
    return -row[2] * v[3 - place]  # CROSS: by the other motor's speed


@njit(cache=True, error_model="numpy")
def rates(x, dx, command, outside, dry, smooth, dahl, links, drives, v, force):
    """x' of a state; `dry` are the torques (n,) of `frictions` kept over the step, as forces (4,)."""
    speeds(x, links, drives, v)
    for i in range(4):
        force[i] = dry[i]
    twist = links[1] * sin(x[1] - x[0]) * v[0] * v[1]
    force[0] += twist - links[3] * sin(x[0])
    force[1] += -twist - links[4] * sin(x[1])
    for i in range(2):
        goal = allowed(command[i], v[2 + i], drives, i)
        lag = drives[LAG, i]
        now = x[12 + i] if lag > 0.0 else goal
        dx[12 + i] = (goal - now) / lag if lag > 0.0 else 0.0
        dx[14 + i] = (v[2 + i] - x[14 + i]) / drives[FILTER, i] if drives[FILTER, i] > 0.0 else 0.0
        torque = drives[GAIN, i] * now + drives[BIAS, i] + outside[i] - drives[DAMPING, i] * v[2 + i]
        push(i, torque, drives, force)
        if drives[STIFFNESS, i] > 0.0:
            wind, half = x[2 + i] - x[i], 0.5 * drives[GAP, i]
            bent = wind - min(max(wind, -half), half)
            if half == 0.0 or bent != 0.0:
                through = drives[STIFFNESS, i] * bent + drives[SERIES, i] * (v[2 + i] - v[i])
                force[i] += through
                force[2 + i] -= through
    for k in range(len(smooth)):
        push(int(smooth[k, 1]), smooth_torque(smooth[k], x, v), drives, force)
    for k in range(len(dahl)):
        place, z = int(dahl[k, 0]), x[8 + k]
        w = at_place(place, v)
        dx[8 + k] = dahl[k, 2] / dahl[k, 1] * (w - abs(w) * z)
        push(place, -dahl[k, 1] * z, drives, force)
    for i in range(4):
        dx[i] = v[i]
        dx[4 + i] = force[i]


@njit(cache=True, error_model="numpy")
def level(row, slip, at, load):
    """Friction [N m] of one dry effect at a slip speed; of a speed of +-0 the sign is the direction."""
    kind = int(row[0])
    if kind == COULOMB:
        return row[2]
    if kind == STRIBECK:
        return row[2] + (row[3] - row[2]) * exp(-((slip / row[4]) ** 2))
    if kind == UNEVEN:
        return row[4] + row[2] * slip if np.copysign(1.0, slip) > 0.0 else row[5] - row[3] * slip
    if kind == LOADED:
        return row[2] + row[3] * load
    return row[2] * (1.0 + sin(row[3] * at + row[4]))  # PATCHY


@njit(cache=True, error_model="numpy")
def settle(x, h, kept, command, frictions, links, drives, v, work):
    """Changes the step's friction from `kept` (n,) to what the speed at its end asks for.

    `work` (n, 8): speeds (4,) that a unit impulse makes, bounds (2,), predicted slip, change.
    """
    n = len(frictions)
    speeds(x, links, drives, v)
    p4, p5, p6, p7 = x[4], x[5], x[6], x[7]
    unit, push_on = np.zeros(4), np.zeros(4)
    shifted = x.copy()
    for k in range(n):
        place = int(frictions[k, 1])
        push_on[:] = 0.0
        push(place, 1.0, drives, push_on)
        shifted[4:8] = push_on
        speeds(shifted, links, drives, unit)
        work[k, :4] = unit
        slip, at = at_place(place, v), at_place(place, x)
        i = min(place, 1)  # the motor whose torque loads it
        goal = allowed(command[i], v[2 + i], drives, i)
        load = abs(drives[GAIN, i] * (x[12 + i] if drives[LAG, i] > 0.0 else goal))
        work[k, 4] = -level(frictions[k], slip if slip > 0.0 else 0.0, at, load)
        work[k, 5] = level(frictions[k], slip if slip < 0.0 else -0.0, at, load)
        work[k, 6], work[k, 7] = slip, 0.0
    for _ in range(_SWEEPS):
        moved = 0.0
        for k in range(n):
            place = int(frictions[k, 1])
            slip = work[k, 6]
            for j in range(n):
                slip += h * work[j, 7] * at_place(place, work[j, :4])
            own = h * at_place(place, work[k, :4])
            now = kept[k] + work[k, 7]
            new = min(max(now - slip / own, work[k, 4]), work[k, 5])
            moved = max(moved, abs(new - now))
            work[k, 7] += new - now
        if moved < _TIGHT:
            break
    x[4], x[5], x[6], x[7] = p4, p5, p6, p7
    for k in range(n):
        kept[k] += work[k, 7]
        push_on[:] = 0.0
        push(int(frictions[k, 1]), h * work[k, 7], drives, push_on)
        for i in range(4):
            x[4 + i] += push_on[i]
            x[i] += 0.5 * h * h * work[k, 7] * work[k, i]  # the mean of the speed's change over the step
