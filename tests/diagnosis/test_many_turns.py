"""A wheel that turns many times in one log."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from workbench.core import Recording
from workbench.diagnosis import diagnose
from workbench.effects import load_model
from workbench.recordings import load_recordings

_STEP, _INERTIA = 2e-3, 0.03


def _wheel(folder: Path, mean: float, damping: tuple[float, float], seconds: float) -> list[Recording]:
    """Two logs of a wheel that a torque about a mean [N m] pushes; damping of the wheel and of its model."""
    t, generator = np.arange(0.0, seconds, _STEP), np.random.default_rng(5)
    for k in range(2):
        torque = mean + 0.5 * mean * np.sign(np.sin(0.8 * t + k)) + 0.8 * np.sin((7.0 + 2.0 * k) * t)
        q, w, states = 0.0, 0.0, []
        for asked in torque:
            states.append((q, w))
            for _ in range(8):
                w += (asked - damping[0] * w) / _INERTIA * _STEP / 8
                q += w * _STEP / 8
        seen = np.array(states) + generator.normal(0.0, [1e-4, 0.01], (len(t), 2))
        rows = np.column_stack([t, seen, torque, torque + generator.normal(0.0, 0.01, len(t))])
        np.savetxt(folder / f"r{k}.csv", rows, delimiter=",", header="t,q,w,c,tau", comments="")
        (folder / f"r{k}.toml").write_text(
            f'format = 1\nname = "r{k}"\ntable = "r{k}.csv"\naxes = ["wheel"]\n[columns]\ntime = "t"\n'
            'position = "q"\nvelocity = "w"\ntorque_command = "c"\ntorque_measured = "tau"\n'
            '[controller]\nkind = "none"\n'
        )
    (folder / "wheel.xml").write_text(
        '<mujoco><worldbody><body><joint name="wheel" axis="0 0 1" armature="0.01" '
        f'damping="{damping[1]}"/><inertial pos="0 0 0" mass="1" diaginertia="0.02 0.02 0.02"/></body>'
        "</worldbody></mujoco>"
    )
    return list(load_recordings([folder / f"r{k}.toml" for k in range(2)]))


def test_a_number_is_found_over_more_turns_than_a_ripple_needs(tmp_path: Path) -> None:
    recordings = _wheel(tmp_path, 80.0, (0.05, 0.02), 6.0)
    assert np.ptp(recordings[0].position) > 2.0 * np.pi * 1100
    (found,) = diagnose(load_model(str(tmp_path / "wheel.xml")), recordings).findings
    assert found.key.effect == "viscous_damping"
    assert found.parameters["damping"].value == pytest.approx(0.03, rel=0.02)
