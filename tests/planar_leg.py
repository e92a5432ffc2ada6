"""A planar leg of two links moved along a path, with the torque that its motion takes: no loop, no search."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from workbench.core import Controller, Recording

LEG = """<mujoco model="leg"><compiler angle="radian"/><worldbody>
 <body name="thigh"><joint name="hip" type="hinge" axis="0 -1 0" armature="0.012" damping="0.05"/>
  <inertial pos="0 0 -0.09" mass="1.6" diaginertia="0.008 0.008 0.0016"/>
  <body name="shank" pos="0 0 -0.22"><joint name="knee" type="hinge" axis="0 -1 0" armature="0.012"
   damping="0.05"/><inertial pos="0 0 -0.1" mass="0.7" diaginertia="0.004 0.004 0.0008"/></body></body>
 </worldbody></mujoco>"""
MOTION, TORQUE = ("position", "velocity", "position_reference"), ("torque_command", "torque_measured")


def write_leg(folder: Path) -> Path:
    """The leg's MJCF file."""
    path = folder / "leg.xml"
    path.write_text(LEG)
    return path


def moved(*, friction: float = 0.2, seed: int = 0, rows: int = 3000, lowest_hz: float = 0.3) -> Recording:
    """A recording of the leg at 500 Hz under a PD law that is logged, joint coordinates.

    Args:
        friction: dry friction on the hip that the model lacks [N m].
        seed: of the path and the noise.
        rows: of the log.
        lowest_hz: lowest frequency of the path.
    """
    rng, step = np.random.default_rng(seed), 0.002
    t = np.arange(rows) * step
    tones = lowest_hz * np.array([[1.0, 2.3, 5.1], [1.4, 3.1, 6.7]]) * rng.uniform(0.9, 1.1, (2, 3))
    size, phase = np.array([0.35, 0.15, 0.08]), rng.uniform(0, 6, (2, 3))
    angle = 2 * np.pi * tones[..., None] * t + phase[..., None]
    turn = 2 * np.pi * tones[..., None]
    ease, d_ease, dd_ease = _eased(t)
    x, dx, ddx = (
        (size[:, None] * f).sum(axis=1).T
        for f in (np.sin(angle), turn * np.cos(angle), -(turn**2) * np.sin(angle))
    )
    q = ease * x + np.array([-0.3, 0.8])
    v = ease * dx + d_ease * x
    a = ease * ddx + 2 * d_ease * dx + dd_ease * x
    model = mujoco.MjModel.from_xml_string(LEG)
    data, torque = mujoco.MjData(model), np.empty_like(q)
    for k in range(rows):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        torque[k] = data.qfrc_inverse
    torque[:, 0] += friction * np.tanh(v[:, 0] / 0.01)
    kp, kd = np.array([40.0, 40.0]), np.array([1.0, 1.0])
    seen_q, seen_v = np.round(q / 2e-4) * 2e-4, v + rng.normal(0, 0.01, v.shape)
    reference = seen_q + (torque + kd * seen_v) / kp
    signals = {
        "position": seen_q,
        "velocity": seen_v,
        "position_reference": reference,
        "torque_command": torque,
        "torque_measured": torque + rng.normal(0, 0.02, torque.shape),
    }
    law = Controller("pd", "joint", (40.0, 40.0), (1.0, 1.0), period_s=step)
    return Recording("leg", ("hip", "knee"), "joint", t, signals, ("rad", "rad"), controller=law)


def turned(recording: Recording, axis: str, *signals: str) -> Recording:
    """The recording with these signals of an axis negated."""
    side = np.where([name == axis for name in recording.axes], -1.0, 1.0)
    return recording.with_signals(
        **{s: recording.signals[s] * side for s in signals if s in recording.signals}
    )


def without(recording: Recording, *signals: str) -> Recording:
    """The recording without these signals, its loop unknown."""
    kept = {name: x for name, x in recording.signals.items() if name not in signals}
    return replace(recording, signals=kept, controller=Controller())


def _eased(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A start from rest within half a second, its rate and its rate's rate, (N, 1)."""
    s = np.clip(t / 0.5, 0, 1)[:, None]
    inside = (s < 1).astype(float)
    return (
        s**3 * (10 - 15 * s + 6 * s**2),
        inside * 30 * s**2 * (1 - s) ** 2 / 0.5,
        inside * 60 * s * (1 - s) * (1 - 2 * s) / 0.25,
    )
