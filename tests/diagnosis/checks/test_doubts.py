"""What a diagnosis would refuse is said beside a comparison, which is made all the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from tests.planar_leg import moved, write_leg
from workbench.core import Recording
from workbench.diagnosis import doubts
from workbench.effects import load_model


def scaled(recording: Recording, motion: np.ndarray | float) -> Recording:
    named = ("position", "velocity", "position_reference")
    return recording.with_signals(**{n: motion * recording.signals[n] for n in named})


def test_a_sign_a_unit_and_nothing(tmp_path: Path) -> None:
    model = load_model(str(write_leg(tmp_path)))
    right = moved()
    assert doubts(model, [right]) == ()
    (sign,) = doubts(model, [scaled(right, np.array([1.0, -1.0]))])
    assert sign.startswith(f"{right.name}: ") and "has the opposite sign" in sign and "refuses this" in sign
    degrees = replace(scaled(right, np.pi / 180), guessed_units=("position",))
    (unit,) = doubts(model, [degrees])
    assert "possible unit error" in unit and "degrees and radians" in unit
