"""Gains of the position actuators that an MJCF states."""

from __future__ import annotations

from pathlib import Path

import pytest

from workbench.effects import load_model
from workbench.models import servos_of

_ARM = """<mujoco><compiler angle="radian"/><option timestep="0.004"/><worldbody>
<body><joint name="lift" axis="0 1 0"/><geom size="0.05" pos="0.2 0 0" mass="1"/>
<body pos="0.4 0 0"><joint name="reach" type="slide"/><geom size="0.05" mass="1"/></body></body></worldbody>
<actuator>{}</actuator></mujoco>"""
_LIFT, _REACH = '<position joint="lift" kp="50" kv="3"/>', '<position joint="reach" kp="900" kv="40"/>'


def arm(folder: Path, actuators: str) -> Path:
    file = folder / "arm.xml"
    file.write_text(_ARM.format(actuators))
    return file


def test_position_actuators_are_a_loop_joint_by_joint(tmp_path: Path) -> None:
    found = servos_of(load_model(arm(tmp_path, _REACH + _LIFT)))
    assert found is not None
    assert (found.kp, found.kd, found.step) == ((50.0, 900.0), (3.0, 40.0), 0.004)


@pytest.mark.parametrize(
    "actuators",
    [
        "",
        _LIFT,
        _LIFT + '<motor joint="reach"/>',
        _LIFT + '<velocity joint="reach" kv="3"/>',
        _LIFT + _REACH.replace("kp", 'gear="2" kp'),
        _LIFT + _REACH.replace("kp", 'timeconst="0.1" kp'),
        _LIFT + _REACH + _REACH,
    ],
)
def test_other_actuators_are_none(tmp_path: Path, actuators: str) -> None:
    assert servos_of(load_model(arm(tmp_path, actuators))) is None
