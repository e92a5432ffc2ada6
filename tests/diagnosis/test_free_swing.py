"""A swing that nothing drives shows friction and inertia, and nothing where nothing is missing."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.free_motion import MASS, Torque, friction, nothing, pendulum, recorded, swing
from workbench.core import Diagnosis
from workbench.diagnosis import diagnose


def asked(folder: Path, torque: Torque = nothing, more: float = 0.0, duration: float = 10.0) -> Diagnosis:
    logs = [recorded(swing(a, torque, more, duration), seed=k) for k, a in enumerate((1.2, 0.6, 0.9))]
    return diagnose(pendulum(folder), logs[:2], logs[2:])


@pytest.mark.parametrize(
    ("effect", "parameter", "value", "torque", "more"),
    [
        ("viscous_damping", "damping", 0.012, friction(viscous=0.012), 0.0),
        ("coulomb_friction", "torque", 0.02, friction(coulomb=0.02), 0.0),
        ("reflected_inertia", "inertia", 0.03, nothing, 0.03),
    ],
)
def test_one_missing_effect_is_named_with_its_size(
    tmp_path: Path, effect: str, parameter: str, value: float, torque: Torque, more: float
) -> None:
    found = asked(tmp_path, torque, more)
    assert found.verdict == "missing_effect"
    assert [f.key.effect for f in found.findings] == [effect]
    estimate = found.findings[0].parameters[parameter]
    assert abs(estimate.value - value) < max(3.0 * estimate.std, 0.01 * value)
    assert effect not in {k.effect for k in found.not_excited}
    assert "torque_constant_error" in {k.effect for k in found.not_excited}, "no motor pushed"
    assert any("no payload was searched for" in note for note in found.notes)


def test_nothing_is_invented(tmp_path: Path) -> None:
    found = asked(tmp_path)
    assert found.verdict == "consistent"
    assert found.notes and all("each swing is simulated" in note for note in found.notes)


def test_a_spring_of_another_law_is_not_the_nearest_effect(tmp_path: Path) -> None:
    found = asked(tmp_path, lambda t, q, w: -0.3 * MASS * q**3, duration=5.0)
    assert found.verdict == "unexplained"
    assert not found.findings
