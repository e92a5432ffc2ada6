"""One axis in a simulation that steps otherwise than ours: what is right, and nothing beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import workbench as wb
from tests.rotor import pushed, torn, wandering
from workbench.core import Diagnosis

_LOOP = (3.0, 0.08)


def diagnosed(folder: Path, stated: float = 0.0, **hidden: Any) -> Diagnosis:
    """Three motions to fit, one to judge, by sensors that see half a step; the model states dry friction."""
    sensors = {"counts": 65536, "wobble": 0.005, "noise": 0.005}
    runs = [
        pushed(folder, wandering(k), _LOOP, **sensors, **hidden, seed=k, name=f"run {k}") for k in range(4)
    ]
    file = folder / "rotor.xml"
    file.write_text(file.read_text().replace("armature", f'frictionloss="{stated}" armature'))
    return wb.diagnose(wb.load_model(str(file)), runs[:3], runs[3:])


def test_half_a_step_is_nothing_missing(tmp_path: Path) -> None:
    found = diagnosed(tmp_path)
    assert found.verdict == "consistent" and not found.findings


def test_half_a_step_is_nothing_beside_what_is_missing(tmp_path: Path) -> None:
    found = diagnosed(tmp_path, friction=lambda w: 0.02)
    assert [f.key.effect for f in found.findings] == ["coulomb_friction"]
    assert found.findings[0].parameters["torque"].value == pytest.approx(0.02, rel=0.03)


def test_a_constant_torque_is_no_spring_that_rests_far_away(tmp_path: Path) -> None:
    found = diagnosed(tmp_path, bias=0.05)
    assert [f.key.effect for f in found.findings] == ["torque_bias"]


def test_of_pairs_that_explain_all_the_fewest_numbers_win(tmp_path: Path) -> None:
    # less gain is more inertia and weight: a payload, with friction that leans to one side, looks the same
    found = diagnosed(tmp_path, gain=0.88, friction=lambda w: 0.02)
    assert {f.key.effect for f in found.findings} == {"torque_constant_error", "coulomb_friction"}


def test_friction_of_slow_motion_that_held_out_never_shows(tmp_path: Path) -> None:
    def friction(w: float) -> float:
        return 0.02 + 0.03 * float(np.exp(-((w / 0.2) ** 2)))

    sensors = {"counts": 65536, "wobble": 0.005, "noise": 0.005}
    t = np.arange(2000) * 0.002
    slow = 0.25 * np.arcsin(np.sin(2 * np.pi * 0.4 * t))
    fast = 0.3 * np.sin(2 * np.pi * 2.5 * t) * np.minimum(t, 1.0)
    runs = [
        pushed(tmp_path, r, _LOOP, friction=friction, **sensors, seed=k, name=f"run {k}")
        for k, r in enumerate((slow, wandering(1), fast))
    ]
    found = wb.diagnose(wb.load_model(str(tmp_path / "rotor.xml")), runs[:2], runs[2:])
    assert [f.key.effect for f in found.findings] == ["stribeck_friction"]
    assert found.findings[0].parameters["static"].value == pytest.approx(0.05, rel=0.2)


def test_a_loop_far_beyond_its_limit_is_no_riddle(tmp_path: Path) -> None:
    sensors = {"counts": 65536, "wobble": 0.005, "limit": 0.5}
    runs = [
        pushed(tmp_path, wandering(k, 1500), (30.0, 0.3), **sensors, seed=k, name=f"run {k}")
        for k in range(2)
    ]
    runs.append(pushed(tmp_path, 2.0 * torn(1500), (30.0, 0.3), **sensors, seed=5, name="torn"))
    found = wb.diagnose(wb.load_model(str(tmp_path / "rotor.xml")), runs[:2], runs[2:])
    assert found.findings and found.findings[0].key.effect == "torque_saturation"
    assert found.findings[0].parameters["limit"].value == pytest.approx(0.5, rel=0.01)


def test_friction_that_falls_through_the_stated_is_one_law(tmp_path: Path) -> None:
    """Who fits a constant to it states something between standstill and motion."""
    found = diagnosed(tmp_path, 0.045, friction=lambda w: 0.03 + 0.04 * np.exp(-((w / 1.5) ** 2)))
    (finding,) = found.findings
    assert finding.key.effect == "stribeck_friction"
    assert finding.parameters["coulomb"].value == pytest.approx(-0.015, abs=0.002)
    assert finding.parameters["static"].value == pytest.approx(0.025, abs=0.004)


def test_a_constant_torque_by_friction_is_friction_of_two_sizes(tmp_path: Path) -> None:
    found = diagnosed(tmp_path, 0.03, friction=lambda w: 0.03, bias=-0.05)
    (finding,) = found.findings
    assert finding.key.effect == "torque_bias"
    assert finding.parameters["torque"].value == pytest.approx(-0.05, rel=0.05)
    assert [k.effect for k in finding.indistinguishable_from] == ["asymmetric_friction"]
