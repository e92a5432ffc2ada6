"""Two causes at once: all pairs are solved side by side, and a true pair is found."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from tests.diagnosis.rig import asked, recordings
from workbench.core import EffectKey
from workbench.diagnosis.fitting.normal_equations import normal
from workbench.diagnosis.hypothesis import Fit
from workbench.diagnosis.moves.pairs import best_pair, left_by
from workbench.diagnosis.screening.equations import Entry
from workbench.diagnosis.search_result import AcceptedStep
from workbench.effects import load_model
from workbench.rigs import HiddenEffect


def test_pairs_side_by_side_leave_what_each_leaves_by_itself() -> None:
    random = np.random.default_rng(3)
    response = random.standard_normal((40, 2, 1, 6)) * 10.0 ** random.uniform(-3, 3, 6)
    residual = random.standard_normal((40, 2, 1))
    entries = [
        Entry(EffectKey("viscous_damping", "hip"), {}, [0], None, 1.0),
        Entry(EffectKey("cogging", "knee"), {}, [1, 2], None, 1.0),
        Entry(EffectKey("backlash", "knee"), {}, [], 3, 1.0),
        Entry(EffectKey("asymmetric_friction", "hip"), {}, [4, 5], None, 1.0),
    ]
    pairs = list(combinations(entries, 2))
    found = left_by(normal(response, residual), pairs)
    rows, target = response.reshape(-1, 6), residual.ravel()
    for (one, other), left in zip(pairs, found, strict=True):
        own = [*one.linear, *other.linear]
        rest = target - rows[:, [e.fixed for e in (one, other) if e.fixed is not None]].sum(axis=1)
        best = rows[:, own] @ np.linalg.lstsq(rows[:, own], rest, rcond=None)[0] if own else 0.0
        assert left == pytest.approx(np.sum((rest - best) ** 2), rel=1e-6)


def found(*hidden: HiddenEffect) -> tuple[Fit, tuple[AcceptedStep, ...]]:
    """The leg as it is believed, and the pair that explains what these do."""
    problem = asked(load_model("leg"), *recordings(*hidden))
    return problem.start, best_pair(problem)


def test_a_true_pair_is_found() -> None:
    hidden = (
        HiddenEffect("load_dependent_friction", "hip", parameters={"torque": 0.06, "ratio": 0.1}),
        HiddenEffect("encoder_eccentricity", "knee", parameters={"amplitude": 0.08, "phase": 1.9}),
    )
    start, steps = found(*hidden)
    assert {step.added.effect for step in steps} == {h.effect for h in hidden}
    for applied, h in zip(
        sorted(steps[1].fit.hypothesis.free, key=lambda a: a.key.effect, reverse=True), hidden, strict=True
    ):
        for name, value in h.parameters.items():
            assert applied.parameters[name].value == pytest.approx(value, rel=0.1)
    assert start.test_loss > steps[0].fit.test_loss > steps[1].fit.test_loss


def test_two_of_three_causes_are_a_pair() -> None:
    """Beside what the third leaves, the smaller of the two is little of the whole and much of its axis."""
    friction = {"damping_positive": 0.126, "damping_negative": 0.032}
    hidden = (
        HiddenEffect(
            "asymmetric_friction",
            "hip",
            parameters={**friction, "torque_positive": 1.263, "torque_negative": 0.316},
        ),
        HiddenEffect("torque_bias", "knee", parameters={"torque": -0.226}),
        HiddenEffect("command_delay", parameters={"time": 0.00027}),
    )
    _, steps = found(*hidden)
    assert [str(s.added) for s in steps] == ["asymmetric_friction@hip", "torque_bias@knee"]
    assert steps[1].fit.hypothesis.free[0].values["torque"] == pytest.approx(-0.226, abs=0.03)


def test_a_single_cause_is_no_pair() -> None:
    training, _ = recordings(HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.15}))
    assert best_pair(asked(load_model("leg"), training[:2])) == ()
