"""A search ends by what it has simulated, never by the clock, and says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench.diagnosis import diagnose
from workbench.diagnosis.policy import trial
from workbench.diagnosis.work_budget import WorkBudget
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

from .rig import recordings

BOTH = (
    HiddenEffect("coulomb_friction", "hip", parameters={"torque": 0.5}),
    HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.3}),
)


def test_work_is_counted_in_steps_of_coordinates() -> None:
    (one, *_), _ = recordings(seed=1)
    seldom = replace(one, time=one.time * 10.0)
    counts = []
    for recording in (one, seldom):
        count = WorkBudget()
        count.add((recording,), 3)
        counts.append(count.done)
    assert counts[0] == 3 * len(one) * 2
    assert counts[1] == pytest.approx(10 * counts[0]), "between rows far apart there are steps too"
    assert not WorkBudget().spent
    assert WorkBudget(most=1.0, done=2.0).spent


def test_more_data_may_take_more_work() -> None:
    training, _ = recordings(seed=1)
    assert WorkBudget.for_search(training).most < WorkBudget.for_search(training * 50).most


def test_a_search_that_ends_early_says_so_and_is_the_same_again() -> None:
    tone = {"torque": 0.4, "frequency": 3.7, "phase": 0.3}
    training, held_out = recordings(HiddenEffect("periodic_disturbance", "knee", parameters=tone))
    model = load_model("leg")
    with trial(budget_steps=1e5, budget_runs=1):
        first, again = (diagnose(model, training, held_out) for _ in range(2))
    assert first.stopped == "budget"
    assert first.work == again.work > 1e5
    assert any("before every candidate was tried" in line for line in first.evidence)
    assert [f.key for f in first.findings] == [f.key for f in again.findings]
    assert first.unexplained_fraction == again.unexplained_fraction
    assert np.isfinite(first.unexplained_fraction)


def test_a_search_that_finds_everything_says_nothing_of_it() -> None:
    training, held_out = recordings(BOTH[0])
    found = diagnose(load_model("leg"), training, held_out)
    assert [f.key.effect for f in found.findings] == ["coulomb_friction"]
    assert found.stopped == "noise"
