"""What is certain beside a torque that is in no catalogue: a tone, or one with a mean."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, NUMBERS, SLOW, bench_arm, logged
from tests.diagnosis.rig import asked
from workbench.core import Controller
from workbench.diagnosis.moves.joint_solution import solve_jointly
from workbench.effects import load_model
from workbench.models import AppliedEffect

_STEP_S = 2.5e-4  # of the arm's simulation


def certain(
    folder: Path, number: str, increment: float, stranger: Callable[[float, np.ndarray], float]
) -> dict[str, AppliedEffect]:
    """What is certain of an arm with a wrong number, and on bend a torque of time and positions."""
    machine = bench_arm(folder, "machine", **{number: NUMBERS[number] + increment})
    logs = []
    for k, tones in enumerate((SLOW, FAST)):
        steps = count()

        def resisting(q: np.ndarray, w: np.ndarray, steps: Iterator[int] = steps) -> np.ndarray:
            return np.array([0.0, 0.0, stranger(_STEP_S * next(steps), q)])

        logs.append(logged(machine, tones, seconds=6.0, seed=k, resisting=resisting))
    along = [replace(log, controller=Controller()) for log in logs]
    node = solve_jointly(asked(load_model(bench_arm(folder)), along, ()))
    assert node is not None and not node.done
    return {str(a.key): a for a in node.current.hypothesis.free}


def test_a_rotor_is_certain_beside_a_tone_on_its_axis(tmp_path: Path) -> None:
    found = certain(tmp_path, "bend_armature", 0.05, lambda t, q: 0.8 * np.sin(2.0 * np.pi * 6.0 * t + 1.0))
    assert list(found) == ["reflected_inertia@bend"]
    inertia = found["reflected_inertia@bend"].parameters["inertia"]
    assert inertia.value == pytest.approx(0.05, abs=1.96 * inertia.std + 0.001)


def test_the_mean_of_an_unknown_torque_is_no_torque_bias(tmp_path: Path) -> None:
    found = certain(tmp_path, "lift_damping", 2.0, lambda t, q: 0.8 * np.sin(q[0] + 1.0))
    assert list(found) == ["viscous_damping@lift"]
