"""What a robot with a base that floats lacks is found from its pose, with force plates and without."""

from __future__ import annotations

import pytest

from tests import floating_robot
from workbench.core import EffectKey
from workbench.diagnosis import diagnose
from workbench.effects import load_model
from workbench.models import Model


@pytest.fixture(scope="module")
def robot(tmp_path_factory) -> Model:
    folder = tmp_path_factory.mktemp("robot")
    floating_robot.write_robot(folder)
    return load_model(folder / "robot.toml")


def test_the_friction_of_one_drive_is_found_without_plates(robot: Model) -> None:
    torque = tuple(0.6 if axis == "rl_knee" else 0.0 for axis in floating_robot.AXES)
    found = diagnose(robot, [floating_robot.recorded(1.0, seed=1, coulomb=torque, plates=False)])
    assert found.verdict == "missing_effect"
    assert [f.key for f in found.findings] == [EffectKey("coulomb_friction", "rl_knee")]
    estimate = found.findings[0].parameters["torque"]
    assert abs(estimate.value - 0.6) < 3.0 * estimate.std < 0.06


def test_a_load_on_the_trunk_is_found_and_weighed(robot: Model) -> None:
    found = diagnose(robot, [floating_robot.recorded(1.0, seed=1, cargo=2.0)])
    assert found.verdict == "missing_effect"
    assert [f.key for f in found.findings] == [EffectKey("payload_mass", None)]
    estimate = found.findings[0].parameters["mass"]
    assert abs(estimate.value - 2.0) < 3.0 * estimate.std < 0.2
