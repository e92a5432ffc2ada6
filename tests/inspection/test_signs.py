"""A torque's sign without a command: by what axes do to each other, by work, by a law that pushes away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.planar_leg import MOTION, TORQUE, moved, turned, without
from workbench.core import Controller, Recording
from workbench.inspection import Remark, inspect


def signs(recording: Recording) -> list[Remark]:
    return [r for r in inspect([recording]).recordings[0].remarks if r.topic == "sign"]


@pytest.mark.parametrize("seed", range(3))
def test_a_sound_log_raises_no_alarm(seed: int) -> None:
    assert signs(moved(seed=seed)) == []
    assert signs(without(moved(seed=seed), "torque_command", "position_reference")) == []


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("axis", ["hip", "knee"])
def test_few_tones_tell_the_sign_where_axes_push_each_other(axis: str, seed: int) -> None:
    bare = without(moved(seed=seed, lowest_hz=0.6), "torque_command", "position_reference")
    (remark,) = signs(turned(bare, axis, *TORQUE))
    assert (remark.axis, remark.severity) == (axis, "problem")


def test_a_law_that_nobody_stated_and_that_pushes_away() -> None:
    found = signs(replace(turned(moved(), "knee", *MOTION), controller=Controller()))
    assert any("kp -40" in r.text and r.axis == "knee" for r in found)


def dragged(side: float, seconds: float = 20.0) -> Recording:
    """One axis that moves slowly against dry friction: nothing to accelerate, only work."""
    t = np.arange(int(seconds / 0.005)) * 0.005
    rng = np.random.default_rng(0)
    q, v = -np.cos(0.8 * t) / 0.8, np.sin(0.8 * t)
    torque = side * (0.5 * np.tanh(v / 0.02) + 0.2 * q) + rng.normal(0, 0.02, len(t))
    signals = {"position": q, "velocity": v, "torque_measured": torque}
    return Recording("slow", ("a",), "joint", t, {n: x[:, None] for n, x in signals.items()}, ("rad",))


def test_drives_do_not_live_on_friction() -> None:
    assert signs(dragged(1.0)) == []
    (remark,) = signs(dragged(-1.0))
    assert remark.axis == "a" and "more out of the machine" in remark.text


def slow_arm(seed: int, seconds: float = 16.0, period: float = 0.002) -> Recording:
    """Return an arm of two links that a soft PD loop moves slowly against gravity; it sags at the start."""
    rng = np.random.default_rng(seed)
    length, near, far, masses, inertia = 0.35, 0.16, 0.17, (3.0, 2.4), (0.036, 0.045)
    kp, kd = np.array([150.0, 90.0]), np.array([9.0, 5.0])

    def acceleration(q: np.ndarray, v: np.ndarray, u: np.ndarray) -> np.ndarray:
        bend, turn = masses[1] * length * far * np.cos(q[1]), masses[1] * length * far * np.sin(q[1])
        elbow = inertia[1] + masses[1] * far**2
        shoulder = inertia[0] + masses[0] * near**2 + elbow + masses[1] * length**2 + 2 * bend
        outer = masses[1] * far * 9.81 * np.cos(q.sum())
        weight = np.array([(masses[0] * near + masses[1] * length) * 9.81 * np.cos(q[0]) + outer, outer])
        whirl = turn * np.array([-(2 * v[0] + v[1]) * v[1], v[0] ** 2])
        mass = np.array([[shoulder, elbow + bend], [elbow + bend, elbow]])
        return np.linalg.solve(mass, u - 0.4 * v - whirl - weight)

    start = q = np.array([0.9, -1.1])
    v, rows = np.zeros(2), []
    time = np.arange(int(seconds / period)) * period
    for t in time:
        wave = np.array([0.4, 0.5]) * np.sin(2 * np.pi * np.array([0.37, 0.43]) * t)
        seen, speed = q + 1e-4 * rng.normal(size=2), v + 2e-3 * rng.normal(size=2)
        u = kp * (start + wave * min(1.0, t / 2) - seen) - kd * speed
        rows.append((seen, speed, u + 0.03 * rng.normal(size=2)))
        middle = v + period / 2 * acceleration(q, v, u)
        v, q = v + period * acceleration(q + period / 2 * v, middle, u), q + period * middle
    names = ("position", "velocity", "torque_measured")
    signals = {name: np.array(x) for name, x in zip(names, zip(*rows, strict=True), strict=True)}
    return Recording("slow arm", ("shoulder", "elbow"), "joint", time, signals, ("rad", "rad"))


@pytest.mark.parametrize("seed", range(3))
def test_an_arm_that_sags_and_then_moves_slowly_is_no_alarm(seed: int) -> None:
    assert signs(slow_arm(seed)) == []
