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
