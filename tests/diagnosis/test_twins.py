"""What no log of some kind can tell apart is named together."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.simulation.make import leg_experiment
from workbench.core import EffectKey, Recording
from workbench.diagnosis.naming import equivalents_of
from workbench.effects import load_model
from workbench.simulation import Run, simulate

LEG = load_model("leg")


@pytest.fixture(scope="module")
def log() -> Recording:
    asked = leg_experiment(0.3)
    made = simulate([Run(LEG, asked)])[0]
    # a command that is also what was measured was not measured
    return made.with_signals(torque_measured=made.signals["torque_measured"] + 1e-6)


@pytest.mark.parametrize(
    "late, other", [("command_delay", "sensor_delay"), ("sensor_delay", "command_delay")]
)
def test_delays_are_one_thing_where_the_torque_was_not_measured(
    log: Recording, late: str, other: str
) -> None:
    silent = replace(log, signals={k: v for k, v in log.signals.items() if k != "torque_measured"})
    assert equivalents_of(LEG, EffectKey(late, None), [silent]) == (EffectKey(other, None),)
    assert (
        equivalents_of(LEG, EffectKey(late, None), [log])
        == equivalents_of(LEG, EffectKey(late, None), [log, silent])
        == ()
    )


def test_unequal_friction_is_friction_and_a_bias_in_any_log(log: Recording) -> None:
    assert EffectKey("torque_bias", "hip") in equivalents_of(
        LEG, EffectKey("asymmetric_friction", "hip"), [log]
    )
