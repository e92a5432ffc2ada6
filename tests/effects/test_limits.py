"""Where a loop asks for far more than its drive gives, the channel says what that is without a simulation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.comparison import replay_of
from workbench.core import Controller, EffectKey, Recording
from workbench.effects import compile_plant, effect_named, load_model
from workbench.models import Placement

_ROTOR = """<mujoco><worldbody><body><joint name="m" axis="0 -1 0" armature="0.004" damping="0.01"/>
<inertial pos="0.05 0 0" mass="0.4" diaginertia="0.0002 0.0006 0.0006"/></body></worldbody></mujoco>"""
_STEP = 0.002


def pushed(folder: Path, limit: float, stall: float, fastest: float) -> Recording:
    """A rotor that is torn to and fro with 50 times the torque of its drive."""
    (folder / "rotor.xml").write_text(_ROTOR)
    generator = np.random.default_rng(0)
    t = np.arange(3000) * _STEP
    reference = np.sin(2.0 * np.pi * 3.0 * t) * np.minimum(t, 1.0)
    q = w = 0.0
    rows = []
    for r in reference:
        asked = 60.0 * (r - q) - 0.4 * w
        ceiling = np.clip(stall * (1.0 - np.sign(asked) * w / fastest), 0.0, stall)
        given = float(np.clip(asked, -min(limit, ceiling), min(limit, ceiling)))
        rows.append((q, w, asked, given + 0.01 * generator.standard_normal(), r))
        for _ in range(20):
            w += _STEP / 20 * (given - 0.01 * w - 0.4 * 9.81 * 0.05 * np.cos(q)) / 0.0056
            q += _STEP / 20 * w
    names = ("position", "velocity", "torque_command", "torque_measured", "position_reference")
    signals = {name: column[:, None] for name, column in zip(names, np.array(rows).T, strict=True)}
    loop = Controller("pd", "actuator", kp=(60.0,), kd=(0.4,), period_s=_STEP)
    return Recording("r", ("m",), "actuator", t, signals, ("rad",), controller=loop)


@pytest.mark.parametrize(
    "effect, wanted",
    [
        ("torque_saturation", {"limit": 1.2}),
        ("speed_torque_limit", {"stall_torque": 1.5, "no_load_speed": 25.0}),
    ],
)
def test_the_first_guess_is_the_limit(tmp_path: Path, effect: str, wanted: dict[str, float]) -> None:
    far = {"limit": 1e9, "stall_torque": 1e9, "no_load_speed": 1e9, **wanted}
    recording = pushed(tmp_path, far["limit"], far["stall_torque"], far["no_load_speed"])
    model = load_model(str(tmp_path / "rotor.xml"))
    assert np.abs(recording.signals["torque_command"]).max() > 30.0
    replay = replay_of(model, [recording])
    [[run]] = replay.run([model])
    motion = replay.motion(compile_plant(model), 0, replace(run, source=None))
    shapes = effect_named(effect).shapes([motion], model, Placement.of(model, EffectKey(effect, "m")))
    assert len(shapes) == 1
    for name, value in wanted.items():
        assert shapes[0][name] == pytest.approx(value, rel=0.02)
