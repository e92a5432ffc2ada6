"""The exam is fair: its cases stay what they were, and its marks are what an answer deserves."""

from collections import Counter

import numpy as np
import pytest
from exam.answers import Answer, Named, with_truth
from exam.cases import KINDS, ODD, all_cases
from exam.experiments import experiments_for
from exam.outsiders import OUTSIDE
from exam.table import mistakes

from exam import scoring
from workbench.core import EffectKey
from workbench.effects import load_model
from workbench.rigs import DRAWN_EFFECTS, OUTSIDERS, HiddenEffect
from workbench.rigs.hidden import install
from workbench.rigs.machine import Machine
from workbench.rigs.magnitudes import SMALLEST

FRICTION = EffectKey("coulomb_friction", "knee")
AT_PIN = EffectKey("coulomb_friction", "knee", "joint")
BIAS = EffectKey("torque_bias", "hip")
INERTIA = EffectKey("reflected_inertia", "hip")
LINKAGE = EffectKey("linkage_inertia", None)
CASES = all_cases(0)


def answer(*keys: EffectKey, also: tuple[EffectKey, ...] = (), after: float | None = None) -> Answer:
    return Answer("missing_effect", tuple(Named(key, also=also) for key in keys), after)


def result(truth: list[EffectKey], given: Answer, floor: float | None = 1.0) -> str:
    return scoring.outcome(truth, given, scoring.matches(truth, given, floor))


def test_what_is_not_visible_by_the_others_need_not_be_named() -> None:
    named = answer(BIAS)
    found = scoring.matches([BIAS, INERTIA], named, 1.0)
    assert scoring.outcome([BIAS, INERTIA], named, found) == "part"
    assert scoring.outcome([BIAS, INERTIA], named, found, [BIAS]) == "right"
    wrong = answer(BIAS, AT_PIN)
    assert (
        scoring.outcome([BIAS, INERTIA], wrong, scoring.matches([BIAS, INERTIA], wrong, 1.0), [BIAS])
        == "extra"
    )


def test_there_are_enough_cases_of_every_kind_with_names() -> None:
    counts = Counter(case.kind for case in CASES)
    assert len({case.name for case in CASES}) == len(CASES) >= 200
    assert set(counts) == set(KINDS) and min(counts.values()) >= 15
    seats = {(h.effect, h.axis, h.location) for c in CASES if c.kind == "single" for h in c.hidden}
    assert seats == set(SMALLEST)
    assert {case.recorded for case in CASES if case.kind == "clean"} == {"usual", *ODD}
    assert (
        {h.effect for c in CASES if c.kind == "outsider" for h in c.hidden} == set(OUTSIDERS) == set(OUTSIDE)
    )


def test_another_seed_is_another_exam_and_the_same_is_the_same() -> None:
    assert all_cases(0) == CASES
    other = all_cases(1)
    assert not {case.name for case in other} & {case.name for case in CASES}
    hidden = [case.hidden for case in CASES if case.hidden]
    assert not any(case.hidden in hidden for case in other)


def test_any_beginning_is_a_fair_sample() -> None:
    first = CASES[:60]
    share = Counter(case.kind for case in first)
    whole = Counter(case.kind for case in CASES)
    for kind in KINDS:
        assert share[kind] / 60 == pytest.approx(whole[kind] / len(CASES), abs=0.03)
    effects = [h.effect for case in first if case.kind == "single" for h in case.hidden]
    assert len(set(effects)) >= 0.85 * len(DRAWN_EFFECTS)


@pytest.mark.parametrize("case", [c for c in CASES if c.hidden], ids=lambda case: case.name)
def test_the_rig_can_hide_it(case) -> None:
    machine, bare = Machine(), Machine()
    for hidden in case.hidden:
        before = repr(machine)
        install(hidden, machine)
        assert repr(machine) != before
    assert repr(Machine()) == repr(bare)


@pytest.mark.parametrize(
    ("truth", "given", "expected"),
    [
        ([FRICTION], answer(FRICTION), "right"),
        ([FRICTION], answer(AT_PIN), "wrong"),
        ([FRICTION], answer(FRICTION, BIAS), "extra"),
        ([FRICTION], answer(BIAS), "wrong"),
        ([FRICTION], Answer("unexplained"), "unexplained"),
        ([FRICTION], Answer("consistent"), "consistent"),
        ([FRICTION, BIAS], answer(BIAS, FRICTION), "right"),
        ([FRICTION, BIAS], answer(BIAS), "part"),
        ([FRICTION, BIAS], answer(BIAS, AT_PIN), "wrong"),
        ([], answer(BIAS), "wrong"),
        ([], Answer("consistent"), "consistent"),
        (
            [EffectKey("coulomb_friction", "hip", "joint")],
            answer(EffectKey("coulomb_friction", "hip")),
            "right",
        ),
    ],
)
def test_outcomes(truth: list[EffectKey], given: Answer, expected: str) -> None:
    assert result(truth, given) == expected


def test_a_look_alike_has_to_be_real() -> None:
    """Listing everything beside the name is worth nothing; a pair that no data tells apart is."""
    assert result([INERTIA], answer(LINKAGE, also=(INERTIA,))) == "look-alike"
    assert result([INERTIA], answer(LINKAGE)) == "wrong"
    assert result([INERTIA], answer(BIAS, also=(INERTIA, FRICTION), after=2.0)) == "wrong"
    assert result([INERTIA], answer(BIAS, also=(INERTIA, FRICTION), after=1.04)) == "look-alike"
    assert result([INERTIA], answer(BIAS, also=(INERTIA, FRICTION)), floor=None) == "wrong"


def test_one_name_stands_for_one_hidden_effect() -> None:
    both = [INERTIA, EffectKey("payload_mass", None)]
    assert result(both, answer(LINKAGE, also=tuple(both))) == "part"
    twice = answer(INERTIA, LINKAGE, also=(INERTIA,))
    assert result([INERTIA], twice) == "extra"


def test_a_sum_counts_only_where_it_does_as_well() -> None:
    uneven = EffectKey("asymmetric_friction", "knee")
    parts = (FRICTION, EffectKey("torque_bias", "knee"))
    assert result([uneven], answer(*parts, after=1.03)) == "look-alike"
    assert result([uneven], answer(*parts, after=1.5)) == "wrong"
    assert result([uneven], answer(FRICTION, BIAS, after=1.03)) == "extra"


@pytest.mark.parametrize(
    ("kind", "given", "visible", "expected"),
    [
        ("single", "right", True, True),
        ("single", "look-alike", True, True),
        ("single", "consistent", True, False),
        ("single", "consistent", False, True),
        ("single", "unexplained", False, False),
        ("pair", "part", True, False),
        ("clean", "consistent", False, True),
        ("clean", "unexplained", False, False),
        ("outsider", "unexplained", True, True),
        ("outsider", "wrong", True, False),
        ("outsider", "consistent", True, False),
    ],
)
def test_what_is_good(kind: str, given: str, visible: bool, expected: bool) -> None:
    assert scoring.good(kind, given, visible) is expected


def test_error_removed_is_of_what_can_be() -> None:
    assert scoring.removed(5.0, 1.0, 1.0) == 1.0
    assert scoring.removed(5.0, 3.0, 1.0) == 0.5
    assert scoring.removed(5.0, 5.0, 1.0) == 0.0
    assert scoring.removed(1.0, 1.0, 1.0) is None


def test_coverage_knows_turns_and_intervals() -> None:
    assert scoring.covered("torque", 1.0, 1.1, 0.06) and not scoring.covered("torque", 1.0, 1.1, 0.04)
    assert scoring.covered("phase", 0.01, 2 * np.pi - 0.01, 0.02)
    assert scoring.covered("torque", 1.0, 1.1, 0.0) is None


def test_wilson_covers_as_often_as_it_says() -> None:
    generator = np.random.default_rng(0)
    for share in (0.5, 0.9, 0.97):
        hits = [scoring.wilson(int(k), 60) for k in generator.binomial(60, share, 4000)]
        assert np.mean([low <= share <= high for low, high in hits]) == pytest.approx(0.95, abs=0.03)
    assert scoring.wilson(0, 0) == (0.0, 1.0) and scoring.wilson(20, 20)[1] == 1.0


def test_a_case_that_failed_to_run_is_listed_as_such() -> None:
    failed = {"case": "s0-pair-1", "kind": "pair", "truth": [], "failed": "diagnosis: ValueError: no"}
    said = mistakes([failed])
    assert said.splitlines()[0] == "### Failed to run: 1" and "ValueError" in said


def test_the_true_model_has_damped_flanks_as_a_property() -> None:
    values = {"gap": 0.01, "stiffness": 400.0, "damping": 0.8}
    model = with_truth(load_model("leg"), [HiddenEffect("backlash", "knee", parameters=values)])
    assert model.flank_retardation_s == pytest.approx(2e-3)
    assert dict(model.effects[-1].values) == {"gap": 0.01, "stiffness": 400.0}


def test_what_the_demo_cannot_show_gets_its_own_experiment() -> None:
    usual = [e.name for e in experiments_for(["coulomb_friction"])]
    more = [e.name for e in experiments_for(["coulomb_friction", "thermal_derating"])]
    assert len(usual) == 6 and more == [*usual[:-1], "work_and_rest", usual[-1]]
