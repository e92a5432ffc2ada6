"""The loop as a recording states it: rows are logged, ticks command, torque edges come when they come.

Between two edges the leg goes on by equal steps of at most `STEP`; the state of each is kept for some
milliseconds, because late sensors look back.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .equations import FILTER, LAG, STATES, allowed, push, rates, settle, speeds

STEP = 2.5e-5  # s
_KEPT = 1024  # steps that are remembered
_SAME = 1e-9  # s; times closer than this are one


@njit(cache=True, error_model="numpy")
def run(
    period, ticks, delay, late, reference, feedforward, noise, encoder, outside, gains, sensors,
    frictions, smooth, dahl, links, drives,
):  # fmt: skip
    """One experiment; (N, 8): shown angles (2,), shown speeds, commands, torques at the sensor.

    Args:
        period, ticks: of the rows [s], and how many of them a tick is.
        delay, late: of commands and of both sensors [s].
        reference: joint angles (N, 2) [rad]; the run starts at rest at the first.
        feedforward: motor torques (N, 2) [N m].
        noise: of angles and speeds (N, 4).
        encoder: step of the shown angles [rad], 0 for none.
        outside: unmeasured torques of the rows (N, 2) [N m].
        gains: kp and kd of both joints (4,).
        sensors: scale, offset, eccentricity's amplitude and phase (4, 2).
        frictions, smooth, dahl, links, drives: as in `equations`.
    """
    rows = len(reference)
    shown = np.zeros((rows, 8))
    x, v = np.zeros(STATES), np.zeros(4)
    x[0] = x[2] = reference[0, 0]
    x[1] = x[3] = reference[0, 0] + reference[0, 1]
    past = np.zeros((_KEPT, 5))  # time, motors' angles and speeds
    past[0] = 0.0, x[2], x[3], 0.0, 0.0
    count = 1
    commands = np.zeros((rows // ticks + 2, 3))  # when they arrive, and what
    given = taken = 0
    now, asked, kept = np.zeros(2), np.zeros(2), np.zeros(len(frictions))
    work, spare = np.zeros((len(frictions), 8)), np.zeros((6, STATES))
    for row in range(rows):
        t = row * period
        q1, q2, w1, w2 = look(past, count, t - late, sensors)
        q1, q2 = q1 + noise[row, 0], q2 + noise[row, 1]
        if encoder > 0.0:
            q1, q2 = np.rint(q1 / encoder) * encoder, np.rint(q2 / encoder) * encoder
        w1, w2 = w1 + noise[row, 2], w2 + noise[row, 3]
        if row % ticks == 0:
            hip = gains[0] * (reference[row, 0] - q1) - gains[2] * w1
            knee = gains[1] * (reference[row, 1] - (q2 - q1)) - gains[3] * (w2 - w1)
            asked[0] = hip - knee + feedforward[row, 0]
            asked[1] = knee + feedforward[row, 1]
            commands[given] = t + delay, asked[0], asked[1]
            given += 1
        while taken < given and commands[taken, 0] < t + _SAME:
            now[:] = commands[taken, 1:]
            taken += 1
        speeds(x, links, drives, v)
        for i in range(2):
            shown[row, 6 + i] = x[12 + i] if drives[LAG, i] > 0.0 else allowed(now[i], v[2 + i], drives, i)
        shown[row, :6] = q1, q2, w1, w2, asked[0], asked[1]
        end = t + period
        while t < end - _SAME:
            edge = taken < given and commands[taken, 0] < end - _SAME
            until = commands[taken, 0] if edge else end
            steps = max(1, int(np.ceil((until - t) / STEP - 1e-6)))
            h = (until - t) / steps
            for k in range(steps):
                step(x, h, now, outside[row], kept, frictions, smooth, dahl, links, drives, v, work, spare)
                speeds(x, links, drives, v)
                first = x[14] if drives[FILTER, 0] > 0.0 else v[2]
                second = x[15] if drives[FILTER, 1] > 0.0 else v[3]
                past[count % _KEPT] = t + (k + 1) * h, x[2], x[3], first, second
                count += 1
            t = until
            if edge:
                now[:] = commands[taken, 1:]
                taken += 1
        if not abs(v[0]) + abs(v[1]) < 1e3:
            shown[row + 1 :] = np.nan
            break
    return shown


@njit(cache=True, error_model="numpy")
def look(past, count, time, sensors):
    """What both encoders show of the motion at a time: cubic in the angle, straight in the speed."""
    k = count - 1
    while k > 0 and past[k % _KEPT, 0] > time + _SAME:
        k -= 1
    a = past[k % _KEPT]
    b = past[min(k + 1, count - 1) % _KEPT]
    h = b[0] - a[0]
    s = min(max((time - a[0]) / h, 0.0), 1.0) if h > 0.0 else 0.0
    out = np.empty(4)
    for i in range(2):
        bow = (2 * s**3 - 3 * s**2 + 1) * a[1 + i] + (3 * s**2 - 2 * s**3) * b[1 + i]
        angle = bow + h * ((s**3 - 2 * s**2 + s) * a[3 + i] + (s**3 - s**2) * b[3 + i])
        speed = a[3 + i] + s * (b[3 + i] - a[3 + i])
        phase = angle + sensors[3, i]
        out[i] = sensors[0, i] * angle + sensors[1, i] + sensors[2, i] * np.sin(phase)
        out[2 + i] = (sensors[0, i] + sensors[2, i] * np.cos(phase)) * speed
    return out[0], out[1], out[2], out[3]


@njit(cache=True, error_model="numpy")
def step(x, h, command, outside, kept, frictions, smooth, dahl, links, drives, v, work, spare):
    """Runge and Kutta's fourth order with the friction of the step before, then the friction of this one."""
    k1, k2, k3, k4, y = spare[0], spare[1], spare[2], spare[3], spare[4]
    dry, force = spare[5, :4], spare[5, 4:8]
    dry[:] = 0.0
    for k in range(len(frictions)):
        push(int(frictions[k, 1]), kept[k], drives, dry)
    rates(x, k1, command, outside, dry, smooth, dahl, links, drives, v, force)
    for i in range(STATES):
        y[i] = x[i] + 0.5 * h * k1[i]
    rates(y, k2, command, outside, dry, smooth, dahl, links, drives, v, force)
    for i in range(STATES):
        y[i] = x[i] + 0.5 * h * k2[i]
    rates(y, k3, command, outside, dry, smooth, dahl, links, drives, v, force)
    for i in range(STATES):
        y[i] = x[i] + h * k3[i]
    rates(y, k4, command, outside, dry, smooth, dahl, links, drives, v, force)
    for i in range(STATES):
        x[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])
    if len(frictions):
        settle(x, h, kept, command, frictions, links, drives, v, work)
