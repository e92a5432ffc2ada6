"""Gaits with known truth: a legged toy that its own model predicts, and strides of chosen frequency."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.core import Recording

PERIOD = 0.003
FEET = ("left_foot", "right_foot")
JOINTS = ("left_hip", "left_knee", "right_hip", "right_knee")
_LEG = """<body name="{0}_thigh" pos="0 {1} 0">
<joint name="{0}_hip" axis="0 1 0" armature="0.01" damping="0.1"/>
<inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.001"/><body pos="0 0 -0.25">
<joint name="{0}_knee" axis="0 1 0" armature="{2}" damping="0.1"/>
<inertial pos="0 0 -0.1" mass="0.4" diaginertia="0.004 0.004 0.0004"/>
<geom name="{0}_foot" type="sphere" size="0.02" pos="0 0 -0.25" mass="0"/></body></body>"""


def toy(armature: float = 0.01) -> mujoco.MjModel:
    """A trunk with two legs of two joints each."""
    legs = _LEG.format("left", 0.1, armature) + _LEG.format("right", -0.1, armature)
    return mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="0.0005"/><worldbody><body name="trunk" pos="0 0 1"><freejoint/>'
        f'<inertial pos="0 0 0" mass="8" diaginertia="0.1 0.2 0.2"/>{legs}</body></worldbody></mujoco>'
    )


def flight(m: mujoco.MjModel, seconds: float = 0.6, seed: int = 0) -> Recording:
    """The toy thrown up, its legs swinging under torques that are held from row to row; no foot touches."""
    data, rows = mujoco.MjData(m), round(seconds / PERIOD)
    generator = np.random.default_rng(seed)
    rate, phase = generator.uniform(5.0, 20.0, 4), generator.uniform(0.0, 6.28, 4)
    data.qvel[2], data.qvel[3:6] = 3.0, (0.3, -0.5, 0.4)
    kept: dict[str, list[np.ndarray]] = {}
    for row in range(rows):
        torque = 1.5 * np.sin(rate * row * PERIOD + phase)
        for name, value in (
            ("position", data.qpos[7:]), ("velocity", data.qvel[6:]), ("torque_measured", torque),
            ("base_orientation", data.qpos[3:7]), ("base_velocity", data.qvel[:3]),
            ("base_angular_velocity", data.qvel[3:6]),
        ):  # fmt: skip
            kept.setdefault(name, []).append(np.array(value))
        data.qfrc_applied[6:] = torque
        for _ in range(6):
            mujoco.mj_step(m, data)
    kept["ground_force"] = [np.zeros(6)] * rows
    return recording({k: np.array(v) for k, v in kept.items()})


def walk(
    frequency: float = 2.5, duty: float = 0.6, forward: np.ndarray | float = 0.8, force: float = 50.0,
    lift: float = 0.2, seconds: float = 8.0, noise: float = 0.0, seed: int = 0,
) -> Recording:  # fmt: skip
    """Strides of a known frequency and duty factor at a known speed."""
    t = PERIOD * np.arange(round(seconds / PERIOD))
    phase = 2.0 * np.pi * frequency * t
    shift = np.array([0.0, 0.3, np.pi, np.pi + 0.3])
    generator = np.random.default_rng([seed, 4])
    swing = lift * np.sin(phase[:, None] + shift) + noise * generator.standard_normal((len(t), 4))
    stands = np.stack([(phase / 6.2831853 + k) % 1.0 < duty for k in (0.0, 0.5)], axis=1)
    load = np.zeros((len(t), 6))
    load[:, 2::3] = force * stands
    flat = np.zeros((len(t), 3))
    speed = flat.copy()
    speed[:, 0] = forward
    turn = flat.copy()
    turn[:, 2] = 0.5
    return recording(
        {
            "position": swing, "velocity": np.gradient(swing, PERIOD, axis=0), "torque_measured": 3.0 * swing,
            "base_orientation": np.tile([1.0, 0.0, 0.0, 0.0], (len(t), 1)), "base_velocity": speed,
            "base_angular_velocity": turn, "ground_force": load,
        }
    )  # fmt: skip


def recording(values: dict[str, np.ndarray]) -> Recording:
    signals = {k: values[k] for k in ("position", "velocity", "torque_measured")}
    rows = len(values["position"])
    return Recording(
        name="walk", axes=JOINTS, coordinates="actuator", time=PERIOD * np.arange(rows), signals=signals,
        units=("rad",) * 4, extra={k: v for k, v in values.items() if k not in signals},
    )  # fmt: skip
