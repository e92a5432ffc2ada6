"""What recordings can tell apart and how well: against intervals of fits, and in limits."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.core import Diagnosis, EffectKey, Recording
from workbench.diagnosis import diagnose, fit_effect
from workbench.effects import load_model
from workbench.models import Model


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> tuple[Model, list[Recording]]:
    file = bench_arm(tmp_path_factory.mktemp("arm"))
    logs = [logged(file, tones, seconds=6.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    return load_model(file), logs


@pytest.fixture(scope="module")
def told(arm: tuple[Model, list[Recording]]) -> Diagnosis:
    return diagnose(*arm)


def test_expected_deviations_are_those_of_fits(arm: tuple[Model, list[Recording]], told: Diagnosis) -> None:
    model, logs = arm
    assert told.identifiability is not None
    expected = dict(told.identifiability.expected)
    for text in ("viscous_damping@lift", "coulomb_friction@yaw", "reflected_inertia@bend"):
        effect, axis = text.split("@")
        key = EffectKey(effect, axis)
        fitted, _ = fit_effect(model, logs, key)
        (name,) = fitted.parameters
        assert 0.4 < expected[key][name].std / fitted.parameters[name].std < 2.5


def test_what_nothing_tells_apart_is_one_group(told: Diagnosis) -> None:
    known = told.identifiability
    assert known is not None
    # a rotor of the first drive and the inertia of the link that it turns about the same axis
    group = next(g for g in known.groups if EffectKey("reflected_inertia", "yaw") in g)
    assert EffectKey("link_inertia_error", "yaw") in group
    everything = [*known.separable, *known.not_excited, *(k for g in known.groups for k in g)]
    assert len(everything) == len(set(everything))
    # no weight turns a vertical axis
    assert EffectKey("first_moment_error", "yaw") in known.not_excited == told.not_excited


def test_a_drive_that_stands_tells_nothing_of_itself(arm: tuple[Model, list[Recording]]) -> None:
    model, _ = arm
    file = Path(model.serial)
    still = ([(0.0, 0.3, 0.0)], *FAST[1:])
    told = diagnose(model, [logged(file, still, seconds=6.0)])
    silent = {str(k) for k in told.not_excited}
    assert {"viscous_damping@yaw", "cogging@yaw"} <= silent
    assert not silent & {"viscous_damping@lift", "viscous_damping@bend"}


def test_longer_recordings_are_expected_to_tell_more(arm: tuple[Model, list[Recording]]) -> None:
    model, _ = arm
    lengths = [logged(Path(model.serial), SLOW, seconds=t) for t in (1.5, 6.0)]
    key = EffectKey("viscous_damping", "lift")
    short, long = (
        dict(d.identifiability.expected)[key]["damping"].std
        for d in (diagnose(model, [r]) for r in lengths)
        if d.identifiability is not None
    )
    assert long < short


def test_recordings_of_two_machines_disagree_by_what_is_another_in_them(tmp_path: Path) -> None:
    machines = [bench_arm(tmp_path, f"arm_{d}", lift_damping=d) for d in (1.4, 2.4)]
    logs = [replace(logged(m, FAST, seconds=6.0, seed=k), name=f"day_{k}") for k, m in enumerate(machines)]
    told = diagnose(load_model(bench_arm(tmp_path)), logs)
    (found,) = told.disagreeing
    assert (str(found.key), found.recordings) == ("viscous_damping@lift", ("day_0", "day_1"))
    np.testing.assert_allclose(found.values, (0.6, 1.6), rtol=0.1)


def test_recordings_of_one_machine_do_not_disagree(tmp_path: Path, told: Diagnosis) -> None:
    machine = bench_arm(tmp_path, "damped", lift_damping=1.6)
    logs = [logged(machine, tones, seconds=6.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    assert diagnose(load_model(bench_arm(tmp_path)), logs).disagreeing == told.disagreeing == ()
