"""The exam is a package of its own, its cases are the same everywhere, and it marks what answers say."""

import ast
import json
import math
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from workbench_exam.__main__ import hash_of
from workbench_exam.answers import Answer, Named, from_json, read_answer, to_json
from workbench_exam.cases import read_case
from workbench_exam.plants.draw import KINDS, draw, plan
from workbench_exam.plants.drawn import Drawn, true_plant
from workbench_exam.plants.plant import with_effect
from workbench_exam.plants.removed import judge
from workbench_exam.plants.write import drawn_of, truth, write
from workbench_exam.run import answer_all
from workbench_exam.scoring import mark
from workbench_exam.seal import OPEN_KEY, seal, truth_of, unseal
from workbench_exam.table import read_lines, reliability, row, table
from workbench_exam.vocabulary import EFFECTS, MEANING

EXAM = Path(__file__).resolve().parents[2] / "exam"
RIGHT = Named("viscous_damping", "lift", {"damping": (1.06, 1.05, 1.07)}, 0.9)


@cache
def the_arm() -> Drawn:
    """An arm whose file has too little damping; what draws it is compiled first, where it is asked for."""
    return draw(0, "number", 0)


def its_truth() -> dict:
    return {**truth(the_arm()), "one_body": ("yaw",)}


def imported(file: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.add((node.module or "").split(".")[0])
    return found


def test_it_imports_no_workbench_and_solvers_know_no_plants() -> None:
    allowed = {"numpy", "scipy", "workbench_exam", *sys.stdlib_module_names}
    for file in (EXAM / "workbench_exam").rglob("*.py"):
        assert imported(file) <= allowed | ({"numba"} if "plants" in file.parts else set()), file
    for file in (EXAM / "baselines").glob("*.py"):
        assert "workbench" not in imported(file) and "plants" not in file.read_text(), file


def test_solvers_and_the_form_need_no_numba() -> None:
    code = (
        "import sys; sys.modules['numba'] = None\n"
        "import workbench_exam.__main__, workbench_exam.run, workbench_exam.scoring\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env={"PYTHONPATH": str(EXAM)})


def test_a_case_is_that_of_every_other_machine(case: Path) -> None:
    first = (EXAM / "open.sha256").read_text().splitlines()[0]
    assert first == f"{hash_of(case)}  case-000"


def test_a_case_is_in_si_units_and_says_nothing_of_its_truth(case: Path) -> None:
    read = read_case(case)
    assert [r.name for r in read.recordings] == ["slow", "sweep", "work"]
    first = read.recordings[0]
    assert first.signals["position"].shape == (6000, 2)
    asked = read.kp * (first.signals["position_reference"] - first.signals["position"])
    asked = asked - read.kd * first.signals["velocity"]
    np.testing.assert_allclose(asked[:, 0], first.signals["torque_command"][:, 0], atol=2e-3)
    open_text = "".join(f.read_text() for f in case.iterdir() if f.name != "sealed.json")
    assert "0.134238" not in open_text and truth_of(case, OPEN_KEY)["hidden"][0]["values"]["mass"] == 0.134238


def test_other_units_are_the_same_numbers(tmp_path: Path) -> None:
    for way in ("usual", "units"):
        write(replace(the_arm(), way=way), tmp_path / way, OPEN_KEY)
    usual, units = (read_case(tmp_path / way).recordings[1] for way in ("usual", "units"))
    assert "deg" in (tmp_path / "units" / "case.json").read_text()
    np.testing.assert_allclose(units.time, usual.time, atol=1e-6)
    for signal, values in usual.signals.items():
        np.testing.assert_allclose(units.signals[signal], values, atol=2e-5)


def test_a_plan_begins_alike_and_has_all_kinds() -> None:
    assert plan(24) == plan(60)[:24] and {kind for kind, _ in plan(24)} == set(KINDS)
    assert len(plan(60)) == len(set(plan(60))) == 60 and len(plan(200)) == 200


def test_a_truth_says_its_machine() -> None:
    again = drawn_of(json.loads(json.dumps(truth(the_arm()))))
    assert true_plant(again) == true_plant(the_arm()) and again.file == the_arm().file


def test_a_seal_opens_with_its_key_alone() -> None:
    sealed = seal({"kind": "clean"}, "case-007", "secret")
    assert unseal(sealed, "case-007", "secret") == {"kind": "clean"}
    for name, key in (("case-007", "guess"), ("case-008", "secret")):
        with pytest.raises(ValueError, match="does not open"):
            unseal(sealed, name, key)


def test_an_answer_is_the_same_when_read_back() -> None:
    answer = Answer("missing_effect", (replace(RIGHT, also=(("quadratic_drag", "lift"),)),), ("drive worn",))
    assert from_json(json.loads(json.dumps(to_json(answer)))) == answer


@pytest.mark.parametrize(
    ("data", "says"),
    [
        ({"verdict": "maybe"}, "verdict: one of consistent"),
        ({"verdict": "missing_effect", "named": [{"effect": "rust"}]}, r"named\[0\]: effect: 'rust'"),
        (
            {
                "verdict": "missing_effect",
                "named": [{"effect": "cogging", "place": "lift", "values": {"mass": {"value": 1}}}],
            },
            "cogging has torque, order, phase, not 'mass'",
        ),
        (
            {"verdict": "missing_effect", "named": [{"effect": "cogging", "place": "a", "probability": 2}]},
            "probability: from 0 to 1",
        ),
    ],
)
def test_a_wrong_answer_says_where(data: dict, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        from_json(data)


def test_the_truth_as_an_answer_is_right_and_removes_everything() -> None:
    said = tuple(
        Named(h.effect, h.place, {k: (v, 0.9 * v, 1.1 * v) for k, v in h.values.items()}, 1.0)
        for h in the_arm().hidden
    )
    answer = Answer("missing_effect", said)
    marks = mark(its_truth(), answer, 1.0, judge(its_truth(), answer))
    assert (
        marks["good"]
        and marks["removed"] == pytest.approx(1.0)
        and marks["named"][0]["covered"] == {"damping": True}
    )
    nothing = mark(its_truth(), Answer("consistent"), 1.0, judge(its_truth(), Answer("consistent")))
    assert (
        not nothing["good"]
        and nothing["removed"] == 0.0
        and nothing["missed"] == [["viscous_damping", "lift"]]
    )


def test_false_names_verdicts_and_narrow_intervals_are_seen() -> None:
    extra = Named("cogging", "bend")
    marks = mark(its_truth(), Answer("missing_effect", (RIGHT, extra)), 1.0, None)
    assert (marks["false"], marks["good"], [n["is"] for n in marks["named"]]) == (
        1,
        False,
        ["right", "false"],
    )
    assert not mark(its_truth(), Answer("partly_explained", (RIGHT,)), 1.0, None)["good"]
    assert mark(its_truth(), Answer("missing_effect", (RIGHT,), ("worn",)), 1.0, None)["false"] == 1
    narrow = replace(RIGHT, values={"damping": (1.0, 0.99, 1.01)})
    assert mark(its_truth(), Answer("missing_effect", (narrow,)), 1.0, None)["named"][0]["covered"] == {
        "damping": False
    }


def test_what_moves_as_the_truth_and_says_so_is_alike() -> None:
    other = Named("quadratic_drag", "lift", also=(("viscous_damping", "lift"),))
    for after, how in ((0.9, "alike"), (3.0, "false")):
        judged = {"before": 6.5, "after": after, "floor": 0.0}
        assert mark(its_truth(), Answer("missing_effect", (other,)), 1.0, judged)["named"][0]["is"] == how


def test_where_a_link_turns_with_its_rotor_both_are_one() -> None:
    hidden = [{"effect": "reflected_inertia", "place": "yaw", "values": {"inertia": 0.1}, "shows": 5.0}]
    told = its_truth() | {"hidden": hidden}
    link = Answer("missing_effect", (Named("link_inertia_error", "yaw"),))
    assert mark(told, link, 1.0, None)["good"] and not mark(its_truth(), link, 1.0, None)["good"]


def test_of_a_stranger_nothing_is_named() -> None:
    stranger = {"effect": "tone", "place": "yaw", "values": {}, "shows": 9.0}
    told = its_truth() | {"kind": "stranger", "hidden": [], "strangers": [stranger]}
    assert mark(told, Answer("unexplained"), 1.0, None)["good"]
    assert not mark(told, Answer("consistent"), 1.0, None)["good"]
    assert not mark(told, Answer("unexplained", (RIGHT,)), 1.0, None)["abstained"]


def test_every_effect_of_the_vocabulary_can_be_in_a_machine() -> None:
    assert MEANING.keys() == EFFECTS.keys()
    for effect, names in EFFECTS.items():
        values = dict.fromkeys(names, 0.01)
        assert with_effect(the_arm().file, effect, "bend", values) != the_arm().file, effect
    with pytest.raises(ValueError, match="no drive 'tail'"):
        with_effect(the_arm().file, "cogging", "tail", {})


def test_a_solver_that_fails_is_a_failure_in_the_table(case: Path, tmp_path: Path, capsys) -> None:
    (tmp_path / "broken.py").write_text("def solve(case):\n    return 1 / 0\n")
    answer_all(tmp_path / "broken.py", [read_case(case)], tmp_path / "out")
    answer, seconds = read_answer(tmp_path / "out" / "case-000.json")
    assert answer == Answer("consistent") and seconds >= 0.0
    assert "division by zero" in capsys.readouterr().out
    with pytest.raises(ValueError, match="no function solve"):
        (tmp_path / "empty.py").write_text("")
        answer_all(tmp_path / "empty.py", [], tmp_path / "out")


def test_marks_of_a_baseline_are_those_of_every_other_machine(case: Path, tmp_path: Path) -> None:
    """Other libraries change values in their ninth digit or later, and no digit of a mark."""
    answer_all(EXAM / "baselines" / "least_squares_bic.py", [read_case(case)], tmp_path)
    answer, _ = read_answer(tmp_path / "case-000.json")
    (named,) = answer.named
    assert (named.effect, named.place) == ("payload_mass", None)
    assert named.values["mass"] == pytest.approx((0.1205278022, 0.1125637648, 0.1284918396), rel=1e-8)
    told = truth_of(case, OPEN_KEY)
    marks = mark(told, answer, 1.0, judge(told, answer))
    kept = read_lines(EXAM / "open-marks.jsonl")["least_squares_bic"][0]
    timeless = {key: value for key, value in kept.items() if "seconds" not in key}
    assert timeless == {"case": "case-000", **{key: marks[key] for key in timeless.keys() - {"case"}}}
    assert marks["good"] and marks["named"][0]["covered"] == {"mass": False}


def test_a_table_counts() -> None:
    good = mark(its_truth(), Answer("missing_effect", (RIGHT,)), 9.0, None) | {"processor_seconds": 2.0}
    bad = mark(its_truth(), Answer("missing_effect", (Named("cogging", "yaw", {}, 0.6),)), 9.0, None)
    assert math.isnan(row([good, bad])["seconds"])  # a clock on a wall is no measure of work
    bad["processor_seconds"] = 4.0
    figures = row([good, bad])
    assert figures["right"] == (1, 2) and figures["named"] == (1, 2) and figures["seconds"] == 3.0
    assert figures["brier"] == pytest.approx((0.1**2 + 0.6**2) / 2)
    assert reliability([good, bad]) == [(0.6, 0, 1), (0.9, 1, 1)]
    text = table({"mine": [good, bad], "hasty": [bad]})
    assert "| mine | 1 of 2 (9% to 91%) |" in text and "| hasty (answered 1) | 0 of 1" in text
