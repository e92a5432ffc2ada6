"""What an MJCF says and no simulation has: torques of its actuators, and what holds a joint without axis."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from workbench.effects import load_model
from workbench.models import free_joints, limits_left_out

ARM = """<mujoco><worldbody><body><joint name="a" axis="0 1 0"{own}/><geom size="0.1" mass="1"/>
<body pos="0 0 -0.3"><joint name="b" axis="0 1 0"/><geom size="0.1" mass="1"/></body></body></worldbody>
<actuator>{actuators}</actuator></mujoco>"""


@pytest.mark.parametrize(
    "actuators, own, limited",
    [
        ('<motor joint="b" ctrlrange="-20 20" ctrllimited="true"/>', "", "b"),
        ('<position joint="b" kp="9" forcerange="-20 20" forcelimited="true"/>', "", "b"),
        ("", ' actuatorfrcrange="-5 5" actuatorfrclimited="true"', "a"),
        ('<position joint="b" kp="9" ctrlrange="-1 1" ctrllimited="true"/>', "", None),
        ('<motor joint="a"/><motor joint="b"/>', "", None),
    ],
)
def test_a_note_names_the_joints(tmp_path: Path, actuators: str, own: str, limited: str | None) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(ARM.format(actuators=actuators, own=own))
    model = load_model(str(file))
    note = limits_left_out(model)
    assert (note is None) if limited is None else (note is not None and f"actuators on {limited} are" in note)
    stated = replace(model, actuators=replace(model.actuators, torque_limit=(20.0, 20.0)))
    assert limits_left_out(stated) is None


def test_a_note_names_the_joints_that_no_axis_moves(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM.format(actuators="", own=""))
    (tmp_path / "one.toml").write_text('format = 1\nname = "one"\nserial = "arm.xml"\naxes = ["a"]\n')
    note = free_joints(load_model(str(tmp_path / "one.toml")))
    assert note is not None and note.startswith("b of arm.xml is not an axis of the model")
    assert free_joints(load_model(str(tmp_path / "arm.xml"))) is None
