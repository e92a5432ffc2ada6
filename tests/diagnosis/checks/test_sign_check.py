"""A log that has an axis the other way round than its model is refused, before physics is found for it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.rotor import pushed, wandering
from workbench.core import InputError, Recording
from workbench.diagnosis import diagnose
from workbench.effects import load_model


def runs(folder: Path, side: float, friction: float = 0.0) -> list[Recording]:
    made = [
        pushed(folder, wandering(k), (20.0, 0.5), friction=lambda w: friction, seed=k, name=f"r{k}")
        for k in range(2)
    ]
    return [r.with_signals(**{name: side * x for name, x in r.signals.items()}) for r in made]


@pytest.mark.parametrize("friction", [0.0, 0.02])
def test_an_axis_that_was_turned_round_is_told(tmp_path: Path, friction: float) -> None:
    turned = runs(tmp_path, -1.0, friction)
    model = load_model(str(tmp_path / "rotor.xml"))
    with pytest.raises(InputError, match="'m' has the opposite sign to that in model 'rotor'") as refused:
        diagnose(model, turned)
    assert refused.value.column == "m"


def test_friction_alone_is_no_other_sign(tmp_path: Path) -> None:
    straight = runs(tmp_path, 1.0, 0.1)
    found = diagnose(load_model(str(tmp_path / "rotor.xml")), straight)
    assert "coulomb_friction" in {f.key.effect for f in found.findings}
    assert np.isfinite(found.error)
