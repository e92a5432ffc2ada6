"""Beside a torque that acts in a part of the range only, an effect is what it is in the rest."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, logged
from tests.diagnosis.adequacy.test_adequacy import pendulums
from workbench.core import Diagnosis, EffectKey
from workbench.diagnosis import diagnose
from workbench.diagnosis.adequacy.laws import Laws
from workbench.diagnosis.adequacy.part_of_motion import explained_part
from workbench.effects import load_model

Stranger = Callable[[float, float], float]


def told(folder: Path, stranger: Stranger, damping: float) -> Diagnosis:
    """The model has a damping of 0.8, the machine this one, and the stranger resists the first axis."""

    def resisting(q: np.ndarray, w: np.ndarray) -> np.ndarray:
        return np.array([stranger(q[0], w[0]), 0.0, 0.0])

    machine = pendulums(folder, "machine", damping)
    logs = [
        logged(machine, tones, seconds=5.0, seed=k, resisting=resisting)
        for k, tones in enumerate((SLOW, FAST))
    ]
    return diagnose(load_model(pendulums(folder, "model", 0.8)), logs)


def rubbing(q: float, w: float) -> float:
    """Somewhere in the middle of the range it rubs."""
    return -4.0 * np.exp(-(((q - 0.1) / 0.06) ** 2)) * np.tanh(w / 0.02)


def pulling(q: float, w: float) -> float:
    """A cable pulls at one angle, which a sum of ripples follows all the same."""
    return -1.5 * np.exp(-(((q - 0.1) / 0.06) ** 2))


@pytest.mark.parametrize("stranger", [rubbing, pulling])
def test_an_effect_beside_a_rough_patch_has_its_name_and_size(tmp_path: Path, stranger: Stranger) -> None:
    found = told(tmp_path, stranger, 0.5)
    assert found.verdict == "partly_explained"
    sizes = {str(f.key): f.parameters["damping"] for f in found.findings}
    assert set(sizes) == {"viscous_damping@yaw", "viscous_damping@lift", "viscous_damping@bend"}
    for size in sizes.values():
        assert size.value == pytest.approx(-0.3, abs=1.96 * size.std)
        assert size.std < 0.005


def test_friction_beside_a_wide_rough_patch(tmp_path: Path) -> None:
    """No half of the way is without a trace of it; where friction explains most, friction is what it is."""

    def wide(q: float, w: float) -> float:
        return -(0.4 + 0.9 * np.exp(-(((q - 0.4) / 0.25) ** 2))) * np.tanh(w / 0.002)

    found = {str(f.key): f for f in told(tmp_path, wide, 0.8).findings}
    assert set(found) == {"coulomb_friction@yaw"}
    size = found["coulomb_friction@yaw"].parameters["torque"]
    assert size.value == pytest.approx(0.4, rel=0.1) and abs(size.value - 0.4) < 1.96 * size.std


def test_a_rough_patch_alone_is_no_known_effect(tmp_path: Path) -> None:
    found = told(tmp_path, rubbing, 0.8)
    assert found.verdict == "unexplained" and not found.findings


def test_a_recording_that_differs_is_no_part_of_the_motion() -> None:
    random = np.random.default_rng(0)
    moved = [random.uniform(-1.0, 1.0, 400) for _ in range(3)]
    law = np.concatenate(moved)
    noise = 0.01 * random.standard_normal(1200)

    def part_where(times: np.ndarray) -> object:
        torque = (times * law + noise)[:, None]
        laws = Laws(
            (EffectKey("parallel_spring", "lift"),),
            tuple(np.ones(400, bool) for _ in range(3)),
            law[:, None, None],
            torque,
            torque - law[:, None],
            np.array([1e-4]),
        )
        return explained_part(laws, [m[:, None] for m in moved])

    assert part_where(np.where(law > 0.6, 3.0, 1.0)) is not None
    assert part_where(np.repeat([1.0, 0.74, 1.0], 400)) is None
