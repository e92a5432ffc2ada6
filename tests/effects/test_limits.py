"""Where a loop asks for far more than its drive gives, the channel says what that is without a simulation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.rotor import pushed, torn
from workbench.comparison import replay_of
from workbench.core import EffectKey
from workbench.effects import compile_plant, effect_named, load_model, torque_bounds
from workbench.effects.speed_torque_limit import _off
from workbench.models import Placement


@pytest.mark.parametrize(
    "effect, wanted",
    [
        ("torque_saturation", {"limit": 1.2}),
        ("speed_torque_limit", {"stall_torque": 1.5, "no_load_speed": 25.0}),
    ],
)
def test_the_first_guess_is_the_limit(tmp_path: Path, effect: str, wanted: dict[str, float]) -> None:
    short = {"limit": "limit", "stall_torque": "stall", "no_load_speed": "fastest"}
    hidden = {short[name]: value for name, value in wanted.items()}
    recording = pushed(tmp_path, torn(), (60.0, 0.4), **hidden)
    model = load_model(str(tmp_path / "rotor.xml"))
    assert np.abs(recording.signals["torque_command"]).max() > 30.0
    replay = replay_of(model, [recording])
    [[run]] = replay.run([model])
    motion = replay.motion(compile_plant(model), 0, replace(run, source=None))
    shapes = effect_named(effect).parameters.shapes(
        [motion], model, Placement.of(model, EffectKey(effect, "m"))
    )
    assert len(shapes) == 1
    for name, value in wanted.items():
        assert shapes[0][name] == pytest.approx(value, rel=0.02)


@given(
    st.lists(st.tuples(*[st.floats(-50.0, 50.0)] * 3), min_size=1, max_size=20),
    st.floats(0.01, 60.0),
    st.floats(0.01, 100.0),
    st.booleans(),
)
def test_the_compiled_line_is_the_one_that_is_simulated(
    rows: list[tuple[float, float, float]], stall: float, no_load: float, full_braking: bool
) -> None:
    asked, speed, measured = np.array(rows).T
    low, high = torque_bounds(speed, np.array(np.inf), np.array(stall), np.array(no_load), full_braking)
    wanted = np.sum((np.clip(asked, low, high) - measured) ** 2)
    assert _off(asked, speed, measured, stall, no_load, full_braking) == pytest.approx(wanted, abs=1e-9)
