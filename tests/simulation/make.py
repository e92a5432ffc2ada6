"""Experiments made for tests: references and torques that were asked for, and nothing measured yet."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from workbench.core import Controller, EffectKey, Estimate, Recording
from workbench.effects import Plant, axis_units, check_effect
from workbench.models import AppliedEffect, Model
from workbench.simulation import Run, Track, required_torque, simulate, slopes

HOLD = np.array([-0.55, np.pi / 3])  # joint coordinates of the leg [rad]
LEG_LOOP = Controller("pd", "joint", kp=(50.0, 50.0), kd=(1.5, 1.5), period_s=0.003)


def tones(t: np.ndarray, seed: int, amplitude: float, low: float = 0.8, high: float = 9.0) -> np.ndarray:
    """Three random tones, faded in from rest, (N,)."""
    generator = np.random.default_rng(seed)
    out = np.zeros_like(t)
    for f in generator.uniform(low, high, 3):
        out += amplitude / np.sqrt(f) * np.sin(2 * np.pi * f * t + generator.uniform(0, 6.28))
    return out * np.clip(t / 0.3, 0, 1) ** 3


def leg_experiment(
    seconds: float = 1.5,
    period: float = 0.001,
    controller: Controller = LEG_LOOP,
    seed: int = 0,
    amplitude: float = 0.3,
    **changes: Any,
) -> Recording:
    """Both joints of the leg on the move, with a torque multisine on top; `changes` of the recording."""
    t = np.arange(round(seconds / period) + 1) * period
    joints = HOLD + np.stack([tones(t, seed, amplitude), tones(t, seed + 100, amplitude)], axis=1)
    drives = joints @ np.array([[1.0, 1.0], [0.0, 1.0]])
    push = np.stack([tones(t, seed + 200, 1.5, 3, 30), tones(t, seed + 300, 1.0, 3, 30)], axis=1)
    start = np.broadcast_to(drives[0], drives.shape)
    recording = Recording(
        name=f"made_{seed}",
        axes=("hip", "knee"),
        coordinates="actuator",
        time=t,
        signals={
            "position": start,
            "velocity": np.zeros_like(start),
            "position_reference": joints if controller.coordinates == "joint" else drives,
            "torque_feedforward": push,
        },
        units=("rad", "rad"),
        controller=controller,
    )
    return replace(recording, **changes)


def slide_experiment(model: Model, seconds: float = 1.5, seed: int = 0) -> Recording:
    """The slide of the EMPS in its cascade loop."""
    t = np.arange(round(seconds * 1000) + 1) * 0.001
    zero = np.zeros((len(t), 1))
    return Recording(
        name="slide",
        axes=model.axes,
        coordinates="actuator",
        time=t,
        signals={
            "position": zero,
            "velocity": zero,
            "position_reference": tones(t, seed, 0.006, 0.5, 3.0)[:, None],
        },
        units=axis_units(model),
        controller=model.controller,
    )


def arm_experiment(model: Model, seconds: float = 1.5, seed: int = 0) -> Recording:
    """All axes of a small arm on the move in a PD loop."""
    t, n = np.arange(round(seconds * 1000) + 1) * 0.001, model.size
    wanted = np.stack([tones(t, seed + k, 0.5, 0.5, 4.0) for k in range(n)], axis=1)
    loop = Controller("pd", "actuator", kp=(120.0,) * n, kd=(4.0,) * n, period_s=0.001)
    signals = {"position": np.broadcast_to(wanted[0], wanted.shape), "velocity": np.zeros_like(wanted)}
    signals["position_reference"] = wanted
    return Recording("arm", model.axes, "actuator", t, signals, axis_units(model), loop)


def simulated(model: Model, recording: Recording) -> Recording:
    """One run without noise."""
    return simulate([Run(model, recording)])[0]


def having(model: Model, key: EffectKey, **values: float) -> Model:
    """The model with an effect of these parameter values."""
    estimates = {name: Estimate(value, 0.0, "") for name, value in values.items()}
    return model.with_effect(check_effect(model, AppliedEffect(key, estimates)))


def hold_slopes_to_differences(plant: Plant, track: Track) -> None:
    """Slopes of the torque that a motion of two drives needs are what its differences are."""
    _, *found = slopes(plant, track, 0.01)
    moved = 1e-4 * np.array([1.0, -0.5])
    for k, name in enumerate(("acceleration", "velocity", "position")):
        off = [
            required_torque(plant, replace(track, **{name: getattr(track, name) + sign * moved}))
            for sign in (1.0, -1.0)
        ]
        np.testing.assert_allclose(found[k] @ moved, 0.5 * (off[0] - off[1]), rtol=1e-3, atol=1e-8)
