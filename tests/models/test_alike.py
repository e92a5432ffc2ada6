"""Joints that were built alike are known by the numbers of the file, mirrored ones too."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.effects import load_model
from workbench.models import Model, alike_axes

_LEG = """<body name="{side}_thigh" pos="0 {y} 0.5"><joint name="{side}_hip" axis="1 0 0" armature="0.01"/>
 <inertial pos="0.02 {y} -0.1" mass="1" diaginertia="0.01 0.012 0.003"/>
 <body name="{side}_shank" pos="0 0 -0.2"><joint name="{side}_knee" axis="0 1 0" damping="{damping}"/>
  <inertial pos="0 0 -0.1" mass="0.4" diaginertia="0.004 0.004 0.001"/></body></body>"""


@pytest.fixture
def two_legs(tmp_path: Path) -> Model:
    legs = _LEG.format(side="left", y=0.1, damping=0.1) + _LEG.format(side="right", y=-0.1, damping=0.3)
    joints = [f"{side}_{name}" for side in ("left", "right") for name in ("hip", "knee")]
    motors = "".join(f'<motor joint="{j}"/>' for j in joints)
    file = tmp_path / "legs.xml"
    file.write_text(
        f"<mujoco><worldbody>{legs}</worldbody><actuator>{motors}</actuator></mujoco>", encoding="utf-8"
    )
    return load_model(file)


def test_mirrored_hips_are_alike_and_other_knees_are_not(two_legs: Model) -> None:
    assert alike_axes(two_legs) == (("left_hip", "right_hip"),)


def test_a_drive_that_turns_several_joints_is_alike_to_none(two_legs: Model) -> None:
    coupled = np.eye(4)
    coupled[2, 0] = 1.0
    assert alike_axes(replace(two_legs, transmission=coupled)) == ()
