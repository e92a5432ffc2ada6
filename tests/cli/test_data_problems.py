"""What is wrong with recordings stands beside a result that takes them as they are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tests.bench_arm import bench_arm, logged
from workbench.cli.data_problems import data_problems
from workbench.effects import load_model


def test_a_wrong_clock_is_said(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path)
    sound = logged(machine, seconds=4.0)
    slow = replace(sound, time=1.03 * sound.time, name="slow")
    model = load_model(machine)
    assert data_problems(model, [sound]) == ()
    (note,) = data_problems(model, [sound, slow, slow])
    assert note.startswith("slow, slow: Velocity of every axis is 1.03 times") and "workbench inspect" in note
