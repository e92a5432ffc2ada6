"""Columns that hold the joints' own names, and torques of one name of which one hardly moves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import log, text
from workbench.proposing import Answers, open_table, propose

LOG = log()


def put(folder: Path, position: str, effort: str, second: np.ndarray) -> Path:
    data: dict[str, np.ndarray] = {"time": LOG.t}
    data |= {position.format(k + 1): LOG.q[:, k] for k in range(2)}
    data |= {effort.format(k + 1): (LOG.tau[:, 0], second)[k] for k in range(2)}
    (folder / "run.csv").write_text(text(data))
    return folder / "run.csv"


@pytest.mark.parametrize(
    ("position", "effort", "axes"),
    [
        ("q_joint_{}", "tau_joint_{}", ("joint_1", "joint_2")),
        ("arm_{}_joint_position", "arm_{}_joint_effort", ("arm_1_joint", "arm_2_joint")),
        ("q_joint{}", "tau_joint{}", ("joint_1", "joint_2")),
        ("q_motor_{}", "tau_motor_{}", ("motor_1", "motor_2")),
    ],
)
def test_a_joints_own_name_is_known_however_it_is_written(
    position: str, effort: str, axes: tuple[str, ...], tmp_path: Path
) -> None:
    file = put(tmp_path, position, effort, LOG.tau[:, 1])
    proposal = propose(open_table(file), Answers(model_axes=axes))
    assert proposal.description["axes"] == list(axes)
    assert not [q for q in proposal.questions if q.key == "axes"]


@pytest.mark.parametrize("name", ["motor", "lift", "joint"])
@pytest.mark.parametrize("written", ["{}_position", "q_{}", "/arm/{}.position"])
def test_a_name_with_which_another_begins_is_known_too(name: str, written: str, tmp_path: Path) -> None:
    """Twins are called "motor" and "motor_2" by many a tool, and "motor" stands in both."""
    axes = (name, f"{name}_2")
    data = {"time": LOG.t} | {written.format(axis): LOG.q[:, k] for k, axis in enumerate(axes)}
    (tmp_path / "run.csv").write_text(text(data))
    proposal = propose(open_table(tmp_path / "run.csv"), Answers(model_axes=axes[::-1]))
    assert proposal.description["axes"] == list(axes[::-1])
    assert proposal.description["columns"]["position"] == [written.format(axis) for axis in axes[::-1]]
    assert not [q for q in proposal.questions if q.key == "axes"]


def test_a_torque_that_hardly_moves_is_like_those_of_its_name(tmp_path: Path) -> None:
    resting = np.where(np.arange(len(LOG.t)) % 50 < 45, 0.0, LOG.tau[:, 1])
    moving = np.column_stack([LOG.tau[:, 0]] * 2)
    data = {"time": LOG.t} | {
        f"arm_{k + 1}_joint_position": LOG.q[:, k % 2] + 0.01 * k * LOG.q[:, 0] for k in range(3)
    }
    data |= {f"arm_{k + 1}_joint_effort": (moving[:, 0], moving[:, 1], resting)[k] for k in range(3)}
    (tmp_path / "run.csv").write_text(text(data))
    columns = propose(open_table(tmp_path / "run.csv")).description["columns"]
    assert columns["torque_measured"] == [f"arm_{k}_joint_effort" for k in (1, 2, 3)]
    assert "torque_command" not in columns
