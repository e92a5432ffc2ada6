"""A sound log of two axes behind a belt, and mistakes to make in it on purpose."""

from __future__ import annotations

import numpy as np

from workbench.core import Controller, Recording
from workbench.inspection import Remark, inspect

BELT = np.array([[1.0, 0.0], [1.0, 1.0]])
STEP = 2 * np.pi / 16384


def made(seconds: float = 6.0, seed: int = 0) -> Recording:
    """Two axes behind a belt, PD in joint coordinates, ticks of 3 ms, 3 ms delay, sensors with noise."""
    rng = np.random.default_rng(seed)
    dt, hold = 1e-3, 3
    rows = int(seconds / dt)
    t = np.arange(rows) * dt
    reference = np.column_stack([0.3 * np.sin(2 * np.pi * (0.5 + 0.6 * t) * t), 1 + 0.4 * np.sin(9 * t)])
    push = 0.5 * np.column_stack([np.sin(40 * t), np.sin(55 * t + 1)])
    kp, kd, inertia = np.array([30.0, 20.0]), np.array([0.9, 0.7]), np.array([0.03, 0.02])
    q, v = BELT @ reference[0], np.zeros(2)
    out = {k: np.empty((rows, 2)) for k in ("position", "velocity", "torque_command", "torque_measured")}
    command, back = np.zeros(2), np.linalg.inv(BELT)
    for k in range(rows):
        out["position"][k] = np.round(q / STEP) * STEP
        out["velocity"][k] = v + rng.normal(0, 0.015, 2)
        if k % hold == 0:
            error = reference[k] - back @ out["position"][k]
            command = push[k] + back.T @ (kp * error - kd * (back @ out["velocity"][k]))
        out["torque_command"][k] = command
        torque = out["torque_command"][k - 3] if k >= 3 else np.zeros(2)
        out["torque_measured"][k] = torque + rng.normal(0, 0.02, 2)
        change = dt * (torque - 0.1 * v) / inertia
        q = q + dt * (v + change / 2)
        v = v + change
    law = Controller("pd", "joint", kp=(30.0, 20.0), kd=(0.9, 0.7), period_s=0.003)
    signals = {**out, "torque_feedforward": push, "position_reference": reference}
    return Recording("made", ("a", "b"), "actuator", t, signals, ("rad", "rad"), controller=law)


def remarks(recording: Recording, **options: np.ndarray) -> tuple[Remark, ...]:
    return inspect([recording], **options).recordings[0].remarks


def alarms(recording: Recording) -> list[Remark]:
    return [r for r in remarks(recording) if r.severity in ("warning", "problem")]


def times(recording: Recording, signal: str, axis: int, factor: float) -> Recording:
    values = recording.signals[signal].copy()
    values[:, axis] *= factor
    return recording.with_signals(**{signal: values})


def swapped(recording: Recording, *signals: str) -> Recording:
    return recording.with_signals(**{s: recording.signals[s][:, ::-1] for s in signals})


def later(recording: Recording, signal: str, rows: int) -> Recording:
    source = np.clip(np.arange(len(recording)) - rows, 0, len(recording) - 1)
    return recording.with_signals(**{signal: recording.signals[signal][source]})
