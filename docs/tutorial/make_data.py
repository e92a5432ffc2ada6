"""Makes the tutorial's measurements: an arm, simulated from its equations, with something hidden in it.

python docs/tutorial/make_data.py      # writes sweep.csv and check.csv beside this file

Nothing of workbench is used, nor any physics engine: masses, lengths and inertias stand here once more, and
the motion follows from Lagrange's equations. The numbers are logged as a bench would log them: milliseconds,
degrees, an encoder with steps, noise on speed and torque.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
HIDDEN = 0.3  # dry friction in the elbow [N m]: what the tutorial has to find
STEP, ROWS = 2.5e-4, 20  # integration step [s], steps from row to row
KP, KD = np.array([60.0, 80.0, 40.0]), np.array([3.0, 4.0, 1.5])
#: Mass, centre from the joint before, inertia about the centre, next joint; each in its own link's frame.
LINKS = (
    (2.0, (0.0, 0.0, 0.05), (0.012, 0.012, 0.02), (0.0, 0.0, 0.1)),
    (1.6, (0.15, 0.0, 0.0), (0.002, 0.014, 0.014), (0.32, 0.0, 0.0)),
    (0.9, (0.12, 0.0, 0.0), (0.0008, 0.006, 0.006), (0.0, 0.0, 0.0)),
)


def main() -> None:
    """Writes both measurements."""
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 2400
    folder = Path(sys.argv[2]) if len(sys.argv) > 2 else HERE
    for name, seed in (("sweep", 1), ("check", 2)):
        (folder / f"{name}.csv").write_text(measured(seed, rows))


def mass_and_weight(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mass matrix (3, 3) and torque of gravity (3,) at a posture."""
    c0, s0 = np.cos(q[0]), np.sin(q[0])
    mass, weight = np.zeros((3, 3)), np.zeros(3)
    turned = np.array([[c0, -s0, 0.0], [s0, c0, 0.0], [0.0, 0.0, 1.0]])
    place = np.zeros(3)
    axes, places = [np.array([0.0, 0.0, 1.0])], [place]
    for k, (m, centre, inertia, ahead) in enumerate(LINKS):
        if k:
            c, s = np.cos(q[k]), np.sin(q[k])
            axes.append(turned[:, 1].copy())
            places.append(place)
            turned = turned @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        at = place + turned @ np.array(centre)
        spin = np.zeros((3, 3))
        move = np.zeros((3, 3))
        for j in range(k + 1):
            spin[:, j] = axes[j]
            arm = at - places[j]
            a = axes[j]
            move[:, j] = (
                a[1] * arm[2] - a[2] * arm[1],
                a[2] * arm[0] - a[0] * arm[2],
                a[0] * arm[1] - a[1] * arm[0],
            )
        mass += m * move.T @ move + spin.T @ (turned * np.array(inertia)) @ turned.T @ spin
        weight += m * 9.81 * move[2]
        place = place + turned @ np.array(ahead)
    return mass, weight


def acceleration(q: np.ndarray, v: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Lagrange's equations; the derivatives of the mass matrix by differences."""
    mass, weight = mass_and_weight(q)
    h = 1e-5
    slope = np.zeros((3, 3, 3))  # slope[k] = dM/dq_k; nothing depends on the first angle
    for k in (1, 2):
        step = np.zeros(3)
        step[k] = h
        slope[k] = (mass_and_weight(q + step)[0] - mass_and_weight(q - step)[0]) / (2 * h)
    gyro = np.einsum("kij,k,j->i", slope, v, v) - 0.5 * np.einsum("kij,i,j->k", slope, v, v)
    return np.linalg.solve(mass, torque - gyro - weight)


def target(t: float, seed: int) -> np.ndarray:
    """Where the arm is told to be [rad]: slow and fast motion together, from rest."""
    ease = min(1.0, t / 1.5) ** 2 * (3 - 2 * min(1.0, t / 1.5))
    a, b, c = ((1.1, 2.6, 0.7), (0.8, 2.1, 1.5))[seed - 1]
    middle = np.array([0.0, 0.5, 0.8])
    swing = np.array(
        [
            0.6 * np.sin(a * t) + 0.15 * np.sin(4.3 * t),
            0.4 * np.sin(b * t) + 0.1 * np.sin(6.1 * t + 0.5),
            0.5 * np.sin(c * t) + 0.2 * np.sin(3.7 * t + 1.0),
        ]
    )
    return middle + ease * swing


def measured(seed: int, rows: int) -> str:
    """A log as text."""
    rng = np.random.default_rng(seed)
    q, v = target(0.0, seed), np.zeros(3)
    lines = []
    for row in range(rows):
        t = row * STEP * ROWS
        seen_q = np.round(np.degrees(q) / 0.01) * 0.01
        seen_v = np.degrees(v) + rng.normal(0.0, 0.3, 3)
        wanted = np.degrees(target(t, seed))
        command = KP * np.radians(wanted - seen_q) - KD * np.radians(seen_v)
        seen_torque = command + rng.normal(0.0, 0.02, 3)
        lines.append((1000 * t, *seen_q, *seen_v, *wanted, *command, *seen_torque))
        for _ in range(ROWS):
            q = q + 0.5 * STEP * v  # leapfrog: half a step, the push, half a step
            friction = np.array([0.0, 0.0, HIDDEN * np.tanh(v[2] / 0.002)])
            v = v + STEP * acceleration(q, v, command - friction)
            q = q + 0.5 * STEP * v
    joints = ("base", "shoulder", "elbow")
    heads = (
        "{} angle [deg]",
        "{} speed [deg/s]",
        "{} target angle [deg]",
        "{} command [Nm]",
        "{} torque [Nm]",
    )
    names = ["time [ms]", *(head.format(joint) for head in heads for joint in joints)]
    kinds = (
        "{:.0f}",
        *("{:.2f}",) * 3,
        *("{:.3f}",) * 3,
        *("{:.5f}",) * 3,
        *("{:.5f}",) * 3,
        *("{:.4f}",) * 3,
    )
    body = [",".join(kind.format(x) for kind, x in zip(kinds, line, strict=True)) for line in lines]
    return "\n".join([",".join(names), *body]) + "\n"


if __name__ == "__main__":
    main()
