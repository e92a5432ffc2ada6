"""A drive that cuts its command to a limit and logs what is left."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.rotor import pushed, wandering
from workbench.core import Recording
from workbench.diagnosis import diagnose
from workbench.effects import load_model

LIMIT = 0.6


def clamped(recording: Recording) -> Recording:
    return recording.with_signals(torque_command=np.clip(recording.signals["torque_command"], -LIMIT, LIMIT))


def test_a_command_logged_behind_its_limit_shows_the_limit(tmp_path: Path) -> None:
    runs = [
        clamped(pushed(tmp_path, wandering(k), (20.0, 0.5), limit=LIMIT, seed=k, name=f"r{k}"))
        for k in range(3)
    ]
    assert any(np.mean(np.abs(r.signals["torque_command"]) == LIMIT) > 0.01 for r in runs)
    found = diagnose(load_model(str(tmp_path / "rotor.xml")), runs[:2], runs[2:])
    assert [str(f.key) for f in found.findings] == ["torque_saturation@m"]
    assert found.findings[0].parameters["limit"].value == pytest.approx(LIMIT, rel=0.01)
    assert found.findings[0].error_after < 1.1 * found.noise_error
