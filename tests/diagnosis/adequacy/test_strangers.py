"""What is certain beside a torque that is in no catalogue: a tone, a spring of another law, one with a mean."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, NUMBERS, SLOW, bench_arm, logged
from workbench.core import Diagnosis
from workbench.diagnosis import diagnose
from workbench.effects import load_model

_STEP_S = 2.5e-4  # of the arm's simulation


def told(
    folder: Path, number: str, increment: float, stranger: Callable[[float, np.ndarray], float]
) -> Diagnosis:
    """Of an arm with a wrong number, and on bend a torque of time and positions that is no effect."""
    machine = bench_arm(folder, "machine", **{number: NUMBERS[number] + increment})
    logs = []
    for k, tones in enumerate((SLOW, FAST)):
        steps = count()

        def resisting(q: np.ndarray, w: np.ndarray, steps: count[int] = steps) -> np.ndarray:
            return np.array([0.0, 0.0, stranger(_STEP_S * next(steps), q)])

        logs.append(logged(machine, tones, seconds=8.0, seed=k, resisting=resisting))
    return diagnose(load_model(bench_arm(folder)), logs)


def test_a_rotor_is_certain_beside_a_tone_on_its_axis(tmp_path: Path) -> None:
    found = told(tmp_path, "bend_armature", 0.05, lambda t, q: 0.8 * np.sin(2.0 * np.pi * 6.0 * t + 1.0))
    (finding,) = found.findings
    assert (found.verdict, str(finding.key)) == ("partly_explained", "reflected_inertia@bend")
    inertia = finding.parameters["inertia"]
    assert inertia.value == pytest.approx(0.05, abs=1.96 * inertia.std + 0.001)


def test_certain_effects_are_named_where_what_explains_more_may_not_be(tmp_path: Path) -> None:
    """Damping and a plain spring explain nearly all of damping and a cubic one."""
    found = told(tmp_path, "lift_damping", 2.0, lambda t, q: -1.5 * (q[2] - 0.2) ** 3)
    assert [str(f.key) for f in found.findings] == ["viscous_damping@lift"]
    assert found.findings[0].parameters["damping"].value == pytest.approx(2.0, rel=0.03)


def test_the_mean_of_an_unknown_torque_is_no_torque_bias(tmp_path: Path) -> None:
    found = told(tmp_path, "lift_damping", 2.0, lambda t, q: 0.8 * np.sin(q[0] + 1.0))
    assert found.verdict == "partly_explained"
    assert [str(f.key) for f in found.findings] == ["viscous_damping@lift"]
