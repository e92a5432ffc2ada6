"""A measured drive whose loop nobody tells: friction of a worn screw, found from a bare mass.

With the loop it is the notebook `real_drive`.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from workbench.core import Controller
from workbench.diagnosis import improve
from workbench.effects import load_model
from workbench.recordings import load_recording

from ..data_helpers import emps_toml


def test_friction_by_direction_is_found_without_the_loop(tmp_path: Path) -> None:
    whole = load_recording(emps_toml(tmp_path))
    signals = {k: v for k, v in whole.signals.items() if k != "position_reference"}
    blind = replace(whole, signals=signals, controller=Controller())
    _, better = improve(load_model("emps"), [blind], limit=4)
    friction = next(e for e in better.effects if e.key.effect == "asymmetric_friction").values
    assert friction["damping_positive"] == pytest.approx(166.71, rel=0.03)
    assert friction["damping_negative"] == pytest.approx(240.42, rel=0.03)
    assert friction["torque_positive"] == pytest.approx(20.14, rel=0.03)
    assert friction["torque_negative"] == pytest.approx(20.63, rel=0.03)
