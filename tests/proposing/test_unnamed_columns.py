"""Speeds that are hardly the slope of their positions are known by where they stand."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from workbench.proposing import Answers, open_table, propose
from workbench.proposing.unnamed_columns import by_column_order

T = 0.005 * np.arange(1200)
POSITIONS = ["column_1", "column_2", "column_3"]


def moved(k: int) -> tuple[np.ndarray, np.ndarray]:
    """A position and its speed, of no other frequency than its own."""
    w = 1.3 + 0.9 * k
    return np.sin(w * T + k) + 0.2 * np.sin(3.1 * w * T), w * np.cos(w * T + k) + 0.62 * w * np.cos(
        3.1 * w * T
    )


def test_joints_with_bad_speeds_are_joints(tmp_path: Path) -> None:
    generator = np.random.default_rng(0)
    q, w = (np.column_stack(s) for s in zip(*(moved(k) for k in range(3)), strict=True))
    drift = np.cumsum(generator.normal(0.0, 0.05, (len(T), 2)), axis=0)
    w[:, [0, 2]] += drift - drift.mean(axis=0)
    np.savetxt(
        tmp_path / "run.csv", np.column_stack([q, w, generator.normal(size=(len(T), 3))]), delimiter=","
    )
    description = propose(open_table(tmp_path / "run.csv")).description
    assert description["columns"]["position"] == POSITIONS
    assert description["columns"]["velocity"] == ["column_4", "column_5", "column_6"]


def test_only_neighbours_in_the_same_order_count() -> None:
    names = [f"column_{k}" for k in range(1, 8)]
    alike = {("column_2", "column_5"): 0.99, ("column_3", "column_6"): 0.9, ("column_1", "column_4"): 0.7}
    assert by_column_order({"column_2": "column_5"}, names, alike) == {"column_3": "column_6"}
    assert by_column_order({"column_2": "column_5", "column_1": "column_7"}, names, alike) == {}


def test_a_rival_that_is_as_good_ends_it() -> None:
    names = [f"column_{k}" for k in range(1, 8)]
    alike = {("column_2", "column_5"): 0.99, ("column_3", "column_6"): 0.9, ("column_3", "column_7"): 0.88}
    assert by_column_order({"column_2": "column_5"}, names, alike) == {}


def test_a_joint_that_turns_several_times_is_asked_about(tmp_path: Path) -> None:
    q, w = (np.column_stack(s) for s in zip(*(moved(k) for k in range(2)), strict=True))
    q[:, 1], w[:, 1] = 6.3 * q[:, 1], 6.3 * w[:, 1]
    np.savetxt(tmp_path / "run.csv", np.column_stack([q, w]), delimiter=",")
    questions = propose(open_table(tmp_path / "run.csv"), Answers(rate_hz=200.0)).questions
    assert next(q.best for q in questions if q.key == "unit.position") == "rad"
