"""A measured drive: friction of a worn screw, found from a bare mass."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from workbench.comparison import compare
from workbench.core import Controller, EffectKey
from workbench.diagnosis import improve
from workbench.effects import load_model
from workbench.recordings import load_recording

from ..data_helpers import emps_toml


def test_friction_by_direction_is_found_and_no_spring(tmp_path: Path) -> None:
    whole = load_recording(emps_toml(tmp_path))
    rows = 12_500  # two of the reference's periods
    recording = replace(
        whole,
        time=whole.time[:rows],
        signals={k: v[:rows] for k, v in whole.signals.items()},
        valid=whole.valid[:rows],
    )
    result, better = improve(load_model("emps"), [recording])
    added = [s.key.effect for s in result.steps]
    assert added[:3] == ["coulomb_friction", "viscous_damping", "asymmetric_friction"] or added[:3] == [
        "viscous_damping",
        "coulomb_friction",
        "asymmetric_friction",
    ]
    assert not {"parallel_spring", "velocity_filter_lag", "sensor_delay"} & set(added)
    friction = next(e for e in better.effects if e.key.effect == "asymmetric_friction").values
    assert friction["damping_positive"] == pytest.approx(166.71, rel=0.05)
    assert friction["damping_negative"] == pytest.approx(240.42, rel=0.05)
    assert friction["torque_positive"] == pytest.approx(20.14, rel=0.05)
    assert friction["torque_negative"] == pytest.approx(20.63, rel=0.05)
    last = next(s for s in result.steps if s.key.effect == "asymmetric_friction")
    assert EffectKey("torque_bias", "slide") in last.indistinguishable_from
    torque = compare(better, [whole]).inverse_dynamics
    assert torque is not None and torque.relative_error < 0.031


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
