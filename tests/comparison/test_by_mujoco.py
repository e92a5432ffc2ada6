"""Recordings that MuJoCo made from the model's own file are compared with its steps and its friction."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.mujoco_arm import arm_file, mujoco_log
from workbench.comparison import compare
from workbench.core import InputError


def test_a_log_of_the_files_own_simulation_is_explained(tmp_path: Path) -> None:
    file = arm_file(tmp_path)
    result = compare(file, mujoco_log(file, "own", seed=3))
    assert result.consistent and result.error < 1.02 * result.noise_error
    assert sum("stepped = true in [timing]" in note for note in result.notes) == 1
    stated = tmp_path / "own.toml"
    stated.write_text(stated.read_text() + "[timing]\nstepped = true\n")
    said = compare(file, stated)
    assert said.consistent and not any("MuJoCo seems" in note for note in said.notes)


def test_what_is_stated_to_be_of_a_machine_is_taken_so(tmp_path: Path) -> None:
    file = arm_file(tmp_path)
    log = mujoco_log(file, "own", seed=3)
    log.write_text(log.read_text() + "[timing]\nstepped = false\n")
    result = compare(file, log)
    assert not result.consistent and not any("MuJoCo seems" in note for note in result.notes)


def test_fine_steps_leave_the_soft_friction(tmp_path: Path) -> None:
    file = arm_file(tmp_path)
    result = compare(file, mujoco_log(file, "fine", seed=4, step=1e-4))
    assert result.consistent
    assert sum("soft_friction = true in [timing]" in note for note in result.notes) == 1


def test_along_the_motion_its_friction_turns_early_too(tmp_path: Path) -> None:
    file = arm_file(tmp_path)
    log = mujoco_log(file, "own", seed=7, loop=False)
    result = compare(file, log)
    assert result.consistent
    assert sum("soft_friction = true in [timing]" in note for note in result.notes) == 1


def test_a_wrong_number_stays_one(tmp_path: Path) -> None:
    log = mujoco_log(arm_file(tmp_path, damping=1.6), "damped", seed=5)
    result = compare(arm_file(tmp_path), log)
    assert not result.consistent
    assert not any("MuJoCo seems" in note for note in result.notes)


def test_rows_between_the_steps_of_the_file_are_refused(tmp_path: Path) -> None:
    log = mujoco_log(arm_file(tmp_path), "own", seed=6)
    log.write_text(log.read_text() + "[timing]\nstepped = true\n")
    with pytest.raises(InputError, match=r"timing\.stepped.*steps of 0\.003 s"):
        compare(arm_file(tmp_path, step=0.003), log)
