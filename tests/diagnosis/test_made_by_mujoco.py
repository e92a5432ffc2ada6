"""In recordings that MuJoCo made, what is wrong with a model is found, and its steps are no effect."""

from __future__ import annotations

from pathlib import Path

from tests.mujoco_arm import arm_file, mujoco_log
from workbench.diagnosis import diagnose
from workbench.diagnosis.policy import trial


def test_a_wrong_damping_is_the_only_one(tmp_path: Path) -> None:
    plant = arm_file(tmp_path, damping=1.6)
    logs = [mujoco_log(plant, f"log{k}", seed=k) for k in range(2)]
    with trial(most_effects=1):  # what more the first search would try is not asked here
        found = diagnose(arm_file(tmp_path), logs)
    assert [str(f.key) for f in found.findings] == ["viscous_damping@lift"]
    damping = found.findings[0].parameters["damping"]
    assert abs(damping.value - 0.8) < 3.0 * damping.std < 0.02
    assert any("stepped = true" in note for note in found.notes)


def test_friction_is_named_without_a_loop(tmp_path: Path) -> None:
    plant = arm_file(tmp_path, friction=0.7)
    logs = [mujoco_log(plant, f"log{k}", seed=20 + k, loop=False) for k in range(2)]
    found = diagnose(arm_file(tmp_path), logs)
    assert [str(f.key) for f in found.findings] == ["coulomb_friction@lift"]
    friction = found.findings[0].parameters["torque"]
    assert abs(friction.value - 0.3) < 0.01, "half a step of MuJoCo's is no part of the interval"


def test_nothing_is_missing_from_the_file_itself(tmp_path: Path) -> None:
    file = arm_file(tmp_path)
    found = diagnose(file, [mujoco_log(file, f"log{k}", seed=10 + k) for k in range(2)])
    assert found.verdict == "consistent"
