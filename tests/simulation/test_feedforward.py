"""A log in joint coordinates may have its feedforward in those of the drives: its command tells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.simulation.make import LEG_LOOP, leg_experiment
from workbench.core import Recording
from workbench.effects import load_model
from workbench.simulation import Run, simulate

LEG = load_model("leg")


@pytest.fixture(scope="module", params=["joint", "actuator"])
def logged(request: pytest.FixtureRequest) -> Recording:
    """What a loop in either coordinates logged in those of the drives."""
    loop = replace(LEG_LOOP, coordinates=request.param)
    asked = leg_experiment(0.6, controller=loop)
    made = simulate([Run(LEG, asked)])[0]
    return replace(made, controller=loop).with_signals(
        **{k: v for k, v in asked.signals.items() if k not in made.signals}
    )


def in_joints(log: Recording, *signals: str) -> Recording:
    """The same log in joint coordinates, some torques of it too."""
    j = LEG.transmission
    back = np.linalg.inv(j).T
    moved = {name: log.signals[name] @ back for name in ("position", "velocity")}
    return replace(log, coordinates="joint").with_signals(**moved, **{s: log.signals[s] @ j for s in signals})


TORQUES = ("torque_command", "torque_measured")


@pytest.mark.parametrize("converted", [TORQUES, (*TORQUES, "torque_feedforward")])
def test_the_command_tells(logged: Recording, converted: tuple[str, ...]) -> None:
    log = in_joints(logged, *converted)
    run = simulate([Run(LEG, log)])[0]
    np.testing.assert_allclose(run.position, log.position, atol=1e-9)


def test_without_a_command_it_is_as_all_else(logged: Recording) -> None:
    log = in_joints(logged, *TORQUES, "torque_feedforward")
    silent = replace(log, signals={k: v for k, v in log.signals.items() if k != "torque_command"})
    np.testing.assert_allclose(simulate([Run(LEG, silent)])[0].position, log.position, atol=1e-9)
