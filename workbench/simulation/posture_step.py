"""The inner loop of runs along `posture_run`, compiled: one state after the other, without Python between."""

from __future__ import annotations

import numpy as np

from workbench.core.compiled import compiled


@compiled()
def _values(series: np.ndarray, sizes: np.ndarray, box: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Series (d_1 ... d_n, K) of products of Chebyshev polynomials at `q` (n,) inside the box."""
    basis = np.ones(1)
    for i in range(len(q)):
        x = (2.0 * q[i] - box[i, 0] - box[i, 1]) / (box[i, 1] - box[i, 0])
        own = np.ones(sizes[i])
        if sizes[i] > 1:
            own[1] = x
        for k in range(2, sizes[i]):
            own[k] = 2.0 * x * own[k - 1] - own[k - 2]
        basis = np.outer(basis, own).ravel()
    out = np.zeros(series.shape[1])
    for d in range(series.shape[0]):
        for k in range(series.shape[1]):
            out[k] += basis[d] * series[d, k]
    return out


@compiled()
def _accelerated(
    values: np.ndarray, drives: np.ndarray, begun: np.ndarray, h: float, v: np.ndarray, torque: np.ndarray
) -> np.ndarray:
    """Accelerations (n,) of the joints, from what the series are there: the order is that of their maker."""
    inertia, damping, dry = drives[0], drives[1], drives[2]
    n = len(v)
    count = n * (n + 1) // 2
    upper = np.zeros((n, n), np.int64)
    at = 0
    for i in range(n):
        for j in range(i, n):
            upper[i, j] = upper[j, i] = at
            at += 1
    first_slope = count + 1 + n
    first_pull = first_slope + n * count
    first_jacobian = first_pull + n
    first_bend = first_jacobian + n * n
    mass, pull, jacobian, bends = np.zeros((n, n)), np.zeros(n), np.zeros((n, n)), np.zeros(n)
    for i in range(n):
        pull[i] = -values[first_pull + i]
        for j in range(n):
            mass[i, j] = values[upper[i, j]]
            for k in range(n):
                # Christoffel's symbols: d M_ij / d q_k
                pull[i] -= values[first_slope + k * count + upper[i, j]] * v[j] * v[k]
                pull[i] += 0.5 * values[first_slope + i * count + upper[j, k]] * v[j] * v[k]
    for a in range(n):
        speed, bend = 0.0, 0.0
        for i in range(n):
            speed += values[first_jacobian + i * n + a] * v[i]
            for j in range(n):
                bend += values[first_bend + upper[i, j] * n + a] * v[i] * v[j]
        bends[a] = bend
        acting = torque[a] - damping[a] * speed - inertia[a] * bend
        for i in range(n):
            own = jacobian[a, i] = values[first_jacobian + i * n + a]
            pull[i] += own * acting
            for j in range(n):
                mass[i, j] += inertia[a] * own * values[first_jacobian + j * n + a]
    if not dry.any():
        return np.linalg.solve(mass, pull)
    return with_friction(mass, pull, jacobian, jacobian @ begun + h * bends, drives, h)


@compiled()
def with_friction(
    mass: np.ndarray, pull: np.ndarray, jacobian: np.ndarray, speed: np.ndarray, drives: np.ndarray, h: float
) -> np.ndarray:
    """Return accelerations (n,) with dry friction of the drives, as it is at the end of a piece.

    Each slides one way or the other, or creeps, where friction grows with the speed; which, is tried until it
    fits.

    Args:
        mass: of the joints (n, n) [kg m^2].
        pull: all other forces on them (n,) [N m].
        jacobian: J (n, n).
        speed: of the drives at the end of the piece if nothing accelerates (n,) [rad/s].
        drives: as of `advance`.
        h: length of the piece [s].
    """
    n, dry, creep = len(speed), drives[2], drives[3]
    slides = np.sign(speed) * (np.abs(speed) > creep)
    found, least = np.zeros(n), np.inf
    for attempt in range(2 * n + 3**n):
        whole, left = mass.copy(), pull - jacobian.T @ (dry * slides)
        for a in range(n):
            if slides[a] == 0.0 and dry[a] > 0.0:
                slope = dry[a] / creep[a]
                whole += h * slope * np.outer(jacobian[a], jacobian[a])
                left -= slope * speed[a] * jacobian[a]
        tried = np.linalg.solve(whole, left)
        after = speed + h * (jacobian @ tried)
        fits = np.sign(after) * (np.abs(after) > creep)
        miss = 0.0  # in friction
        for a in range(n):
            crept = after[a] / creep[a]
            taken = crept if slides[a] == 0.0 else slides[a]
            miss = max(miss, dry[a] * abs(taken - min(max(crept, -1.0), 1.0)))
        if miss < least:
            found, least = tried, miss
        if (fits == slides).all():
            break
        slides = fits
        if attempt >= 2 * n - 1:  # that goes round and round: each in turn
            for a in range(n):
                slides[a] = (attempt - 2 * n + 1) // 3**a % 3 - 1.0
    return found


@compiled()
def advance(
    series: np.ndarray, sizes: np.ndarray, box: np.ndarray, drives: np.ndarray, beyond: float, h: float,
    q: np.ndarray, v: np.ndarray, last: np.ndarray, torques: np.ndarray,
) -> int:  # fmt: skip
    """Move states on by as many pieces as there are torques; mass and forces of the middle of each piece.

    Args:
        series: of `PostureDependent`, (d_1 ... d_n, K).
        sizes: d_1 ... d_n.
        box: limits of the joints (n, 2) [rad or m].
        drives: their inertia [kg m^2], damping [N m s/rad], dry friction [N m], and the speed at which that
            is whole [rad/s], (4, n).
        beyond: how far outside the limits things go on as at the edge [rad or m].
        h: length of a piece [s].
        q: positions of the joints (B, n) [rad or m]; changed, as are the next two.
        v: their speeds (B, n) [rad/s or m/s].
        last: their accelerations in the piece before (B, n).
        torques: of the drives in each piece (pieces, B, n) [N m].

    Returns:
        -1, or the number of the state that is too far outside the limits; it is left there.
    """
    n = q.shape[1]
    inside = np.empty(n)
    for piece in range(torques.shape[0]):
        for b in range(q.shape[0]):
            middle = v[b] + 0.5 * h * last[b]
            there = q[b] + 0.5 * h * middle
            for i in range(n):
                inside[i] = min(max(there[i], box[i, 0]), box[i, 1])
                if not abs(there[i] - inside[i]) < beyond:
                    q[b] = there
                    return b
            values = _values(series, sizes, box, inside)
            last[b] = _accelerated(values, drives, v[b], h, middle, torques[piece, b])
            q[b] += h * (v[b] + 0.5 * h * last[b])
            v[b] += h * last[b]
    return -1


@compiled()
def _map(
    middle: np.ndarray, half: np.ndarray, powers: np.ndarray, factors: np.ndarray, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Drive positions (n,) and J (n, n) at joint positions `q` (n,); straight on outside the box."""
    n, terms = len(q), powers.shape[0]
    most = powers.max()
    ladder = np.ones((n, most + 1))
    off = np.empty(n)
    for i in range(n):
        inside = min(max(q[i], middle[i] - half[i]), middle[i] + half[i])
        off[i] = q[i] - inside
        x = (inside - middle[i]) / half[i]
        for k in range(1, most + 1):
            ladder[i, k] = ladder[i, k - 1] * x
    value, slope = np.zeros(n), np.zeros((n, n))
    for t in range(terms):
        whole = 1.0
        for i in range(n):
            whole *= ladder[i, powers[t, i]]
        for a in range(n):
            value[a] += factors[a, t] * whole
        for i in range(n):
            if powers[t, i] == 0:
                continue
            part = powers[t, i] * ladder[i, powers[t, i] - 1] / half[i]
            for j in range(n):
                if j != i:
                    part *= ladder[j, powers[t, j]]
            for a in range(n):
                slope[a, i] += factors[a, t] * part
    return value + slope @ off, slope


@compiled()
def shown(
    middle: np.ndarray, half: np.ndarray, powers: np.ndarray, factors: np.ndarray,
    q: np.ndarray, v: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Return positions and speeds of the drives (B, n) at those of the joints; the first four are a
    `DriveMap`'s."""
    position, speed = np.empty_like(q), np.empty_like(v)
    for b in range(q.shape[0]):
        position[b], slope = _map(middle, half, powers, factors, q[b])
        speed[b] = slope @ v[b]
    return position, speed


@compiled()
def asked(
    middle: np.ndarray, half: np.ndarray, powers: np.ndarray, factors: np.ndarray, tries: int, there: float,
    gains: np.ndarray, wanted: np.ndarray, drives: np.ndarray, speeds: np.ndarray, near: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Return torques of the drives (B, n) that a PD loop in joint coordinates asks for.

    Args:
        middle, half, powers, factors: of the `DriveMap`.
        tries: Newton's steps at most.
        there: a step that is the last [rad or m].
        gains: kp and kd (2, n).
        wanted: positions and speeds of the joints (2, n).
        drives: positions that sensors show (B, n).
        speeds: that sensors show (B, n).
        near: where the joints are about (B, n).
    """
    out = np.empty_like(drives)
    for b in range(drives.shape[0]):
        q = near[b].copy()
        for _ in range(tries):
            value, slope = _map(middle, half, powers, factors, q)
            step = np.linalg.solve(slope, value - drives[b])
            for i in range(len(q)):
                q[i] -= min(max(step[i], -half[i]), half[i])
            if np.abs(step).max() < there:
                break
        _, slope = _map(middle, half, powers, factors, q)
        rate = np.linalg.solve(slope, speeds[b])
        torque = gains[0] * (wanted[0] - q) + gains[1] * (wanted[1] - rate)
        out[b] = np.linalg.solve(np.ascontiguousarray(slope.T), torque)
    return out
