"""Open loops that drift are judged along the measured motion, and those that something holds are not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.comparison import compare
from workbench.comparison.drift import drifts
from workbench.core import Controller, Recording
from workbench.effects import load_model
from workbench.models import Model

_PERIOD = 0.002

_SHAFT = """<mujoco><worldbody><body>
<joint name="a" axis="0 -1 0" armature="0.01" stiffness="{stiffness}" damping="{damping}"/>
<inertial pos="0 0 0" mass="1" diaginertia="0.005 0.01 0.005"/></body></worldbody></mujoco>"""


def shaft(folder: Path, stiffness: float, damping: float) -> Model:
    (folder / "shaft.xml").write_text(_SHAFT.format(stiffness=stiffness, damping=damping))
    return load_model(str(folder / "shaft.xml"))


def played(stiffness: float, damping: float, bias: float = 0.0) -> Recording:
    """The shaft under a multisine, by exact steps of its own; a bias that no model knows of."""
    t = np.arange(2500) * _PERIOD
    generator = np.random.default_rng(1)
    torque = sum(np.sin(2 * np.pi * f * t + generator.uniform(0, 6.28)) for f in range(2, 30, 3))
    torque = torque * np.minimum(t, 0.2) / 0.2
    q = w = 0.0
    position, velocity = np.zeros((2, len(t)))
    for k, u in enumerate(torque):
        position[k], velocity[k] = q, w
        for _ in range(20):  # of a row
            w += _PERIOD / 20 * (u + bias - stiffness * q - damping * w) / 0.02
            q += _PERIOD / 20 * w
    noise = generator.standard_normal((3, len(t)))
    signals = {
        "position": position + 1e-5 * noise[0],
        "velocity": velocity + 1e-3 * noise[2],
        "torque_command": torque,
        "torque_measured": torque + 0.02 * noise[1],
    }
    return Recording(
        name="shaft", axes=("a",), coordinates="actuator", time=t, units=("rad",),
        signals={name: x[:, None] for name, x in signals.items()}, controller=Controller("none"),
    )  # fmt: skip


@pytest.mark.parametrize(
    "stiffness, damping, free", [(0.0, 0.0, True), (0.0, 0.05, True), (30.0, 0.1, False)]
)
def test_a_free_shaft_drifts_and_one_on_a_spring_does_not(
    tmp_path: Path, stiffness: float, damping: float, free: bool
) -> None:
    model, recording = shaft(tmp_path, stiffness, damping), played(stiffness, damping)
    assert drifts(model, [recording]) is free
    assert not drifts(model, [replace(recording, controller=Controller("unknown"))])


def test_a_bias_does_not_hide_that_the_rest_is_right(tmp_path: Path) -> None:
    """Two hundredths of the torque throw the run far off; along the motion they are what they are."""
    biased = played(0.0, 0.0, bias=0.04)
    result = compare(shaft(tmp_path, 0.0, 0.0), [biased], draws=2)
    assert result.error == pytest.approx(0.04 / biased.signals["torque_measured"].std(), rel=0.2)
    assert any("drifts" in note for note in result.notes)


def test_a_right_model_of_a_free_shaft_is_consistent(tmp_path: Path) -> None:
    assert compare(shaft(tmp_path, 0.0, 0.0), [played(0.0, 0.0)], draws=2).consistent
