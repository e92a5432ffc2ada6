"""Delays where torque is measured and no command is logged: one cause, of its size, and no stand-in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.rotor import pushed, wandering
from workbench.core import EffectKey, Recording
from workbench.diagnosis import diagnose
from workbench.diagnosis.data import gather
from workbench.diagnosis.screening.propagation import propagate_sensitivities
from workbench.diagnosis.screening.sensitivity import Linearisation
from workbench.effects import load_model

from .rig import applied

DELAY = EffectKey("command_delay", None)


def run(folder: Path, gains: tuple[float, float], seed: int, **hidden: Any) -> Recording:
    made = pushed(
        folder, wandering(seed, 1500), gains, wobble=0.01, counts=4000, seed=seed, name=f"r{seed}", **hidden
    )
    logged = {name: x for name, x in made.signals.items() if name != "torque_command"}
    return replace(made, signals=logged)


def found(folder: Path, gains: tuple[float, float], **hidden: Any) -> dict[str, dict[str, float]]:
    """Parameters of what a diagnosis names, the second run held out."""
    first, second = (run(folder, gains, seed, **hidden) for seed in (0, 1))
    result = diagnose(load_model(str(folder / "rotor.xml")), [first], [second])
    return {str(f.key): {n: e.value for n, e in f.parameters.items()} for f in result.findings}


def test_a_delay_beside_friction_is_no_two_delays(tmp_path: Path) -> None:
    named = found(tmp_path, (20.0, 0.5), late=3, friction=lambda w: 0.1)
    assert named.keys() == {"command_delay", "coulomb_friction@m"}
    assert named["command_delay"]["time"] == pytest.approx(0.006, abs=1e-4)
    assert named["coulomb_friction@m"]["torque"] == pytest.approx(0.1, rel=0.05)


def test_a_delay_beside_a_gain_that_is_not_the_stated_one(tmp_path: Path) -> None:
    named = found(tmp_path, (20.0, 1.0), late=4, damped=0.35)
    assert named.keys() == {"command_delay", "controller_gain_error@m"}
    assert named["command_delay"]["time"] == pytest.approx(0.008, abs=1e-4)
    assert named["controller_gain_error@m"]["kd_scale"] == pytest.approx(0.35, abs=0.02)


def test_a_delay_moves_what_is_asked_and_not_the_torque_noise(tmp_path: Path) -> None:
    recording = run(tmp_path, (20.0, 0.5), 0, late=2)
    model, more = load_model(str(tmp_path / "rotor.xml")), 2e-5

    def late(seconds: float) -> Any:
        return model.with_effect(applied(model, DELAY, time=seconds))

    data, _ = gather(model, [recording], [], seed=0)
    (now,), (then,) = data.run([late(0.003), late(0.003 + more)])
    linearisation = Linearisation.of(late(0.003), data, (now,), 1)
    ((slope,),) = propagate_sensitivities(
        [linearisation], [linearisation.derivatives(applied(model, DELAY, time=0.003))], data
    )
    moved = (then.position - now.position)[:, 0] / more * data.weight[0, 0]
    foretold = slope[:, 0, 0, 0]
    assert np.linalg.norm(foretold - moved) < 0.15 * np.linalg.norm(moved)
