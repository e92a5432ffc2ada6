"""What is certain beside a torque that is in no catalogue, and has a mean."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, NUMBERS, SLOW, bench_arm, logged
from tests.diagnosis.rig import asked
from workbench.core import Controller
from workbench.diagnosis.moves.joint_solution import solve_jointly
from workbench.effects import load_model
from workbench.models import AppliedEffect


def certain(
    folder: Path, number: str, increment: float, stranger: Callable[[np.ndarray], float]
) -> dict[str, AppliedEffect]:
    """What is certain of an arm with a wrong number, and on bend a torque of positions."""
    machine = bench_arm(folder, "machine", **{number: NUMBERS[number] + increment})

    def resisting(q: np.ndarray, w: np.ndarray) -> np.ndarray:
        return np.array([0.0, 0.0, stranger(q)])

    logs = [
        logged(machine, tones, seconds=6.0, seed=k, resisting=resisting)
        for k, tones in enumerate((SLOW, FAST))
    ]
    along = [replace(log, controller=Controller()) for log in logs]
    node = solve_jointly(asked(load_model(bench_arm(folder)), along, ()))
    assert node is not None and not node.done
    return {str(a.key): a for a in node.current.hypothesis.free}


def test_the_mean_of_an_unknown_torque_is_no_torque_bias(tmp_path: Path) -> None:
    found = certain(tmp_path, "lift_damping", 2.0, lambda q: 0.8 * np.sin(q[0] + 1.0))
    assert list(found) == ["viscous_damping@lift"]


def test_an_inertia_beside_a_tone_has_its_own_size(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path, "machine", bend_armature=NUMBERS["bend_armature"] + 0.03)
    logs = []
    for k, tones in enumerate((SLOW, FAST)):
        clock = iter(np.arange(0.0, 6.0, 2.5e-4))

        def humming(q: np.ndarray, w: np.ndarray, clock: Iterator[float] = clock) -> np.ndarray:
            return np.array([0.0, 0.0, 0.8 * np.sin(2 * np.pi * 5.3 * next(clock))])

        logs.append(logged(machine, tones, seconds=6.0, seed=k, resisting=humming))
    along = [replace(log, controller=Controller()) for log in logs]
    node = solve_jointly(asked(load_model(bench_arm(tmp_path)), along, ()))
    assert node is not None and not node.done
    (found,) = node.current.hypothesis.free
    size = found.parameters["inertia"]
    assert str(found.key) == "reflected_inertia@bend"
    assert size.value == pytest.approx(0.03, abs=1.96 * size.std + 3e-4) and size.std < 3e-3
