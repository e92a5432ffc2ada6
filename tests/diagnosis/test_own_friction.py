"""Friction that a model's file states may be too much: what is found is negative then, and says the total."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.dry_arm import RIGID, dry_arm, made
from workbench.core import EffectKey
from workbench.diagnosis import diagnose
from workbench.effects import load_model
from workbench.report import diagnosis_dict


@pytest.mark.parametrize("stated", [1.0, 0.3])
def test_friction_that_is_stated_wrongly_is_corrected(tmp_path: Path, stated: float) -> None:
    logs = [made(dry_arm(tmp_path, "joint", RIGID, name="machine"), seed=seed) for seed in range(2)]
    file = dry_arm(tmp_path)
    text = file.read_text()
    assert 'frictionloss="0.6"' in text
    file.write_text(text.replace('frictionloss="0.6"', f'frictionloss="{stated}"'))
    found = diagnose(load_model(file), logs[:1], logs[1:])
    assert [f.key for f in found.findings] == [EffectKey("coulomb_friction", "lift")]
    out = diagnosis_dict(found)["findings"][0]
    assert out["parameters"]["torque"]["value"] == pytest.approx(0.6 - stated, abs=0.02)
    assert out["model_value"] == stated
    assert out["total"]["value"] == pytest.approx(0.6, abs=0.02)
    assert out["total"]["std"] == out["parameters"]["torque"]["std"]
