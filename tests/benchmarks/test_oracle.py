"""The oracle's cases stay what they are, and a run against it says better, worse and other rightly."""

from collections import Counter
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest
from exam.against import changes, report
from exam.answers import key_of
from exam.cases import KINDS
from exam.compact import compact, machine_line, read, write
from exam.oracle import EACH, QUICK, oracle_cases
from exam.record import record
from exam.second.cases import ALIKE, second_cases
from exam.second.leg import SecondLeg
from hidden_effects import conclude

from workbench.diagnosis import diagnose

CASES = oracle_cases()
FILE = Path(__file__).parents[2] / "benchmarks" / "oracle.jsonl"


def test_the_order_is_mixed_and_fixed_by_the_seed() -> None:
    assert oracle_cases() == CASES
    assert len({case.name for case in CASES}) == len(CASES) == 2 * EACH
    assert [case.rig for case in CASES] == ["virtual", "second"] * EACH
    quick = CASES[:QUICK]
    assert {case.kind for case in quick} == set(KINDS)
    for kind in KINDS:
        share = sum(c.kind == kind for c in CASES) / len(CASES)
        assert sum(c.kind == kind for c in quick) / QUICK == pytest.approx(share, abs=0.06)
    other = {case.name for case in second_cases(44)}
    assert not other & {case.name for case in CASES}


def test_the_second_leg_hides_every_effect_some_on_both_drives() -> None:
    own = [case for case in CASES if case.rig == "second"]
    alike = [case for case in own if "alike" in case.name]
    assert {case.hidden[0].effect for case in alike} == set(ALIKE)
    for case in alike:
        one, other = case.hidden
        assert (one.axis, other.axis) == ("hip", "knee") and one.parameters == other.parameters
    singles = Counter(h.effect for case in own if case.kind == "single" for h in case.hidden)
    assert len(singles) == 27 and set(singles.values()) == {1}
    for case in own:
        SecondLeg(case.hidden)  # type: ignore[arg-type]


def test_what_is_committed_is_of_these_cases() -> None:
    """A change of what is drawn makes the committed answers those of other questions."""
    cases = {case.name: case for case in CASES}
    for line in read(FILE):
        if not line["case"].startswith("machine-") and "failed" not in line:
            assert line["hidden"] == [str(key_of(h)) for h in cases[line["case"]].hidden]


def test_alike_lags_of_both_drives_are_not_named_as_one_delay(tmp_path: Path) -> None:
    """It was lost once: a delay of the whole machine comes near the noise, and the lags reach it."""
    (case,) = (c for c in CASES if c.name.endswith("alike-current_loop_lag-hip+current_loop_lag-knee"))
    data = record(case, tmp_path)
    some = [r for r in data.training if r.name in ("sweep", "wander")]  # show both, in a third of the time
    found = diagnose(data.model, some, data.held_out, seed=case.seed)
    assert {f.key for f in found.findings} == {key_of(h) for h in case.hidden}


def finding(key: str = "coulomb_friction@knee", how: str = "right", value: float = 0.3) -> dict:
    inside = abs(value - 0.3) < 0.02 if how == "right" else None
    numbers = {"value": value, "std": 0.01, "truth": 0.3, "covered": inside}
    return {"key": key, "is": how, "probability": 0.98, "also": [], "parameters": {"torque": numbers}}


def marks(*findings: dict, good: bool = True, outcome: str = "right", work: float = 1e7, **more) -> dict:
    truth = {"effect": "coulomb_friction", "axis": "knee", "location": "actuator", "parameters": {}}
    line = {"case": "a", "revision": "1", "verdict": "missing_effect", "outcome": outcome, "good": good}
    line |= {"visible": True, "truth": [truth], "findings": list(findings), "work": work, "cpu_s": 20.0}
    return line | more


RIGHT = marks(finding())


@pytest.mark.parametrize(
    ("old", "new", "how", "says"),
    [
        (RIGHT, marks(good=False, outcome="unexplained", verdict="unexplained"), "worse", "-> nothing"),
        (marks(good=False, outcome="consistent"), RIGHT, "better", "named nothing -> coulomb_friction@knee"),
        (
            RIGHT,
            marks(finding("coulomb_friction@knee(joint)", "false"), good=False, outcome="wrong"),
            "worse",
            "(joint) (false)",
        ),
        (RIGHT, marks(finding(value=0.33)), "worse", "torque 0.3 ± 0.0196 (in) -> 0.33 ± 0.0196 (out)"),
        (marks(finding(value=0.33)), RIGHT, "better", "(out) -> 0.3 ± 0.0196 (in)"),
        (RIGHT, marks(finding(value=0.315)), "other", "0.315"),
        (
            marks(finding("torque_bias@hip", "false"), good=False, outcome="wrong"),
            marks(finding("cogging@hip", "false"), good=False, outcome="wrong"),
            "other",
            "torque_bias@hip (false) -> cogging@hip (false)",
        ),
        (RIGHT, marks(finding(), verdict="partly_explained"), "other", "verdict"),
        (RIGHT, marks(finding(), work=2e7), "more work", "2.00 times"),
        (marks(finding(), work=2e7), RIGHT, "less work", "0.50 times"),
        (RIGHT, marks(failed="diagnosis: ValueError: no"), "worse", "ValueError"),
    ],
)
def test_a_change_is_called_what_it_is(old: dict, new: dict, how: str, says: str) -> None:
    (change,) = changes([compact(old)], [compact(new)])
    assert change.how == how and says in change.words


def test_what_did_not_change_is_not_said() -> None:
    same = deepcopy(RIGHT) | {"work": 1.05e7, "cpu_s": 100.0, "revision": "2"}
    assert not changes([compact(RIGHT)], [compact(same)])
    counted = marks(finding(), work=0.0)
    assert [c.how for c in changes([compact(counted)], [compact(counted | {"cpu_s": 50.0})])] == ["more work"]


def test_the_report_counts_only_what_both_have() -> None:
    old = [compact(RIGHT), compact(marks(case="b"))]
    text = report(old, [compact(marks(good=False, outcome="consistent", work=3e7)), compact(marks(case="c"))])
    assert "## Worse: 1" in text and "1 cases in both, 0 as before; 1 of the old not run, 1 new." in text
    assert "Work of 1 cases: 1e+07 -> 3e+07 steps (3.00 times)." in text


def test_the_report_says_which_moves_led_to_answers() -> None:
    plain, pair = "add one effect at a time", "two causes at once"
    new = [compact(marks(moves=[plain])), compact(marks(case="b", moves=[plain, pair]))]
    lines = report([], new).splitlines()
    assert f"- 2: {plain}" in lines and f"- 1: {pair}" in lines and "- 0: other sizes of a gap" in lines


def test_a_machine_is_a_case() -> None:
    value = {"value": 0.2, "std": 0.01, "unit": "N*m"}
    named = {"effect": "coulomb_friction", "axis": "pan", "location": "actuator", "probability": 0.9}
    answer = {"machine": "arm", "verdict": "missing_effect", "seconds": 3.0}
    answer["findings"] = [named | {"parameters": {"torque": value}}]
    answer["marks"] = {"named": 1, "outside": 0, "false": 0, "right": 2, "after": 2.0, "before": 9.0}
    line = machine_line(answer)
    assert line["case"] == "machine-arm" and line["named"][0]["key"] == "coulomb_friction@pan"
    less = deepcopy(answer) | {"findings": [], "verdict": "unexplained"}
    less["marks"] |= {"named": 0}
    assert [c.how for c in changes([line], [machine_line(less)])] == ["worse"]
    broken = {"machine": "arm", "failed": "no answer within 600 s"}
    assert [c.how for c in changes([machine_line(broken)], [line])] == ["better"]


def test_lines_that_are_given_anew_take_the_place_of_the_old(tmp_path: Path) -> None:
    file = tmp_path / "short.jsonl"
    write([compact(marks(case=c)) for c in "ba"], ["a", "b", "c"], file)
    write([compact(marks(finding(), case=c)) for c in "cb"], ["a", "b", "c"], file)
    lines = read(file)
    assert [line["case"] for line in lines] == ["a", "b", "c"]
    assert [len(line["named"]) for line in lines] == [0, 1, 1]
    assert np.all([len(text) < 400 for text in file.read_text().splitlines()])


def test_a_run_that_is_worse_ends_with_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "short.jsonl"
    conclude([RIGHT], None, file, None)
    for given, code in ((RIGHT, 0), (marks(good=False, outcome="consistent"), 1)):
        with pytest.raises(SystemExit) as end:
            conclude([given], None, None, file)
        assert int(end.value.code or 0) == code
    assert "## Worse: 1" in capsys.readouterr().out
