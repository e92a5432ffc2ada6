"""Where no speed was logged, the command tells whether the loop differentiates its encoder."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.simulation.make import LEG_LOOP, having, leg_experiment, simulated
from workbench.core import EffectKey, Recording
from workbench.effects import load_model
from workbench.models import Model
from workbench.simulation import prepare
from workbench.simulation.unlogged_rate import differentiates

LEG = load_model("leg")
OFF = having(LEG, EffectKey("controller_gain_error", "hip"), kp_scale=0.95, kd_scale=1.08)


def logged(model: Model, *, by_ticks: bool) -> Recording:
    """A run whose log has no speed but one computed afterwards, from a loop of either kind."""
    asked = leg_experiment(2.0, controller=LEG_LOOP)
    if by_ticks:
        asked = replace(asked, signals={k: v for k, v in asked.signals.items() if k != "velocity"})
    made = simulated(model, asked)
    signals = {**asked.signals, **made.signals, "velocity": np.gradient(made.position, made.time, axis=0)}
    return replace(asked, signals=signals, derived=("velocity",))


@pytest.mark.parametrize("by_ticks", [True, False])
@pytest.mark.parametrize("model", [LEG, OFF], ids=["stated gains", "other gains"])
def test_the_command_tells_what_the_loop_read(model: Model, by_ticks: bool) -> None:
    assert differentiates(prepare(logged(model, by_ticks=by_ticks), LEG)) is by_ticks
