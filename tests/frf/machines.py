"""A drive and a parallel leg, linear about a posture, simulated exactly in their sampled loops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.signal import lfilter

from workbench.core import Controller, Recording
from workbench.frf import multisine

ROW = 1e-3  # s
DRIVE = {"inertia": 0.0162, "damping": 0.0972, "delay": 0.003}
LEG = {
    "M11": 0.04793,
    "M12": 0.005413,
    "M22": 0.02368,
    "damping_1": 0.0972,
    "damping_2": 0.0972,
    "delay": 0.003,
    "g1": 1.850411,
    "g2": 0.274007,
}


def drive_velocity(torque: np.ndarray, delay: float, inertia: float, damping: float) -> np.ndarray:
    """Velocity at every row of J v' + B v = u(t - T), u held from row to row, (N,)."""
    whole = int(np.floor(delay / ROW + 1e-9))
    part, rate = delay - whole * ROW, damping / inertia
    old = (1 - np.exp(-rate * part)) / damping * np.exp(-rate * (ROW - part))
    new = (1 - np.exp(-rate * (ROW - part))) / damping
    numerator = np.zeros(whole + 3)
    numerator[whole + 1] += new
    numerator[whole + 2] += old
    return lfilter(numerator, [1, -np.exp(-rate * ROW)], torque)


def drive_recording(seed: int = 0, noise: float = 0.05, periods: int = 4, **truth: float) -> Recording:
    """A drive in open loop under a multisine of 0.5 to 100 Hz."""
    d = multisine(["m"], f_min_hz=0.5, f_max_hz=100, period_s=2.0, rate_hz=1 / ROW, periods=periods)
    u = d.play(0)[1]["torque_feedforward"]
    v = drive_velocity(u[:, 0], **{**DRIVE, **truth})[:, None]
    v_noisy = v + noise * np.random.default_rng(seed).normal(size=v.shape)
    signals = {"position": np.cumsum(v, axis=0) * ROW, "velocity": v_noisy, "torque_command": u}
    return Recording(
        name="drive",
        axes=("m",),
        coordinates="actuator",
        time=np.arange(len(u)) * ROW,
        signals={**signals, "torque_feedforward": u},
        units=("rad",),
        excitation=d.excitation(0),
    )


def leg_matrices(posture: Sequence[float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, D, K of the leg about absolute link angles."""
    q = np.asarray(posture)
    mixed = LEG["M12"] * np.cos(q[1] - q[0])
    inertia = np.array([[LEG["M11"], mixed], [mixed, LEG["M22"]]])
    return inertia, 0.0972 * np.eye(2), np.diag([LEG["g1"], LEG["g2"]] * np.cos(q))


def leg_recordings(
    posture: Sequence[float],
    seed: int = 0,
    periods: int = 2,
    noise: tuple[float, float] = (2e-5, 0.02),
    **design: Any,
) -> list[Recording]:
    """Sum and difference multisines on the leg, held by joint feedback at ticks of 3 ms; noise goes round."""
    inertia, damping, stiffness = leg_matrices(posture)
    inverse = np.linalg.inv(inertia)
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ stiffness, -inverse @ damping]])
    values, vectors = np.linalg.eig(a)
    phi = np.real(vectors @ np.diag(np.exp(values * ROW)) @ np.linalg.inv(vectors))
    push = np.linalg.solve(a, (phi - np.eye(4)) @ np.concatenate([np.zeros((2, 2)), inverse]))
    base = {"f_min_hz": 1 / 3, "f_max_hz": 60, "period_s": 3.0, "rms": (0.9, 0.54)}
    d = multisine(["hip", "knee"], **{**base, "rate_hz": 1 / ROW, "periods": periods, **design})
    torque = np.stack([d.play(e)[1]["torque_feedforward"] for e in range(len(d.trials))])
    count, rows, _ = torque.shape
    back = np.linalg.inv([[1.0, 0.0], [1.0, 1.0]])
    gains = np.concatenate([back.T @ (50.0 * np.eye(2)) @ back, back.T @ (1.5 * np.eye(2)) @ back], axis=1)
    generator = np.random.default_rng(seed)
    sensed = np.repeat(noise, 2) * generator.normal(size=(count, rows, 4))
    command = np.zeros((count, rows + 3, 2))  # three rows of delay
    state, held = np.zeros((count, 4)), np.zeros((count, 2))
    for k in range(rows):
        sensed[:, k] += state
        if k % 3 == 0:
            held = torque[:, k] - sensed[:, k] @ gains.T
        command[:, k + 3] = held
        state = state @ phi.T + command[:, k] @ push.T
    return [
        Recording(
            name=d.trials[e].name,
            axes=("hip", "knee"),
            coordinates="actuator",
            time=np.arange(rows) * ROW,
            signals={
                "position": sensed[e, :, :2] + np.asarray(posture),
                "velocity": sensed[e, :, 2:],
                "torque_command": command[e, 3:],
                "torque_feedforward": torque[e],
            },
            units=("rad", "rad"),
            controller=Controller("pd", "joint", (50.0, 50.0), (1.5, 1.5), period_s=0.003),
            excitation=d.excitation(e),
        )
        for e in range(count)
    ]
