"""Of several ways in which a loop may have worked, the answer is the one that needs least."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from exam.field.cases import field_cases
from exam.field.plant import recorded

from workbench.diagnosis import diagnose
from workbench.recordings import load_recording, save_recording


def test_below_the_noise_the_loop_with_fewer_effects_is_taken(tmp_path: Path) -> None:
    """A speed by differences lags half a tick behind a sensor's, and half a tick of damping is a mass."""
    (case,) = [c for c in field_cases("cart", 7) if "positions_alone-1" in c.name]
    assert case.field is not None
    model, made = recorded(replace(case.field, way=replace(case.field.way, duration=8.0)), tmp_path)
    logs = []
    for log in made:
        save_recording(log, tmp_path / f"{log.name}.toml")
        logs.append(load_recording(tmp_path / f"{log.name}.toml"))
    (finding,) = diagnose(model, logs[:2], held_out=logs[2:]).findings
    assert str(finding.key) == "coulomb_friction@cart"
    truth = case.hidden[0].parameters["torque"]
    assert finding.parameters["torque"].value == pytest.approx(truth, rel=0.05)
