"""What is right for each measured machine holds in the committed answers, and live where it takes seconds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import machine_page
import numpy as np
import pytest
import real_machines
from figure_table import figures, filled, like, measured
from machine_cases import CASES
from machine_run import answer
from machine_table import counts, machines, ratio, rows

from tests.data_helpers import data_folder

DOCS = Path(__file__).resolve().parents[2] / "docs"
ANSWERS = real_machines.read(DOCS / real_machines.ANSWERS)
MACHINES = machines()
QUICK = [m for m in MACHINES if m["quick"]]


def held(machine: dict[str, Any], said: dict[str, Any]) -> None:
    """What the table asks for: the causes and values, and at most the error that a version has reached."""
    if "failed" in said:
        assert machine.get("may_fail"), said["failed"]
        return
    reached = machine.get("reached", {})
    found = counts(rows(machine, said))
    assert found["named"] >= reached.get("named", 0)
    assert found["outside"] <= reached.get("outside", 0)
    assert found["false"] <= reached.get("false", 0)
    end = said["judged"]["after" if said["findings"] else "before"]
    assert end["error"] <= reached.get("error", np.inf)
    assert ratio(said, "after") <= 1.02 * ratio(said, "before"), "what was added made it worse"


@pytest.mark.parametrize("machine", MACHINES, ids=lambda m: m["name"])
def test_the_committed_answers_hold_to_what_is_right(machine: dict[str, Any]) -> None:
    held(machine, ANSWERS[machine["name"]])


@pytest.mark.parametrize("machine", QUICK, ids=lambda m: m["name"])
def test_a_machine_that_takes_seconds_holds_to_it_now(machine: dict[str, Any], tmp_path: Path) -> None:
    data = data_folder(machine["folder"]).parent
    held(machine, answer(machine["name"], data, tmp_path))


def test_the_coupled_wrist_explains_what_the_other_cannot() -> None:
    coupled, uncoupled = (ANSWERS[name]["judged"]["after"]["error"] for name in ("tx40", "tx40_uncoupled"))
    assert coupled < 0.85 * uncoupled


def test_the_pages_state_the_committed_answers() -> None:
    page = DOCS / "real-machines.md"
    assert machine_page.page(ANSWERS) == page.read_text(encoding="utf-8"), (
        "docs/real-machines.md is not current: run python analyses/real_machines.py --redraw -o docs"
    )
    [figure] = [f for f in figures() if f["id"] == "machines"]
    new = {v["name"]: like(v["value"], measured(v, DOCS, "")) for v in figure["values"]}
    for stand in figure["stands"]:
        text = (DOCS.parent / stand["file"]).read_text(encoding="utf-8")
        assert f"| {filled(figure, stand['text'], new)} |" in text, stand["row"]


def test_every_machine_has_a_case_and_what_is_right_of_it() -> None:
    assert [m["name"] for m in MACHINES] == list(CASES)
    for machine in MACHINES:
        assert machine.get("may_fail") or "reached" in machine, machine["name"]
        asked = [
            (r["effect"], r.get("axis"), str(r.get("when")), r["parameter"]) for r in machine.get("right", ())
        ]
        assert len(set(asked)) == len(asked)
        for r in (*machine.get("right", ()), *machine.get("read", ())):
            assert ("value" in r) == ("within" in r)


def made(*findings: tuple[str, str, dict[str, float]]) -> dict[str, Any]:
    """An answer that names these, four times the noise with them and ten times without."""
    named = [
        {
            "effect": effect,
            "axis": axis,
            "location": "actuator",
            "parameters": {k: {"value": v, "std": 0.01, "unit": "N*m"} for k, v in values.items()},
        }
        for effect, axis, values in findings
    ]
    errors = ({"error": 10.0, "noise": 1.0}, {"error": 4.0, "noise": 1.0})
    return {"findings": named, "nearest": [], "judged": dict(zip(("before", "after"), errors, strict=True))}


RIPPLE = {
    "right": [
        {
            "effect": "cogging",
            "axis": "m",
            "parameter": "torque",
            "value": 0.8,
            "within": 0.1,
            "when": {"order": 7.0},
        },
        {"effect": "cogging", "axis": "m", "parameter": "torque", "when": {"order": 28.0}},
        {"effect": "coulomb_friction", "axis": "m", "parameter": "torque"},
    ],
    "also": ["viscous_damping@m"],
}


def test_what_is_named_is_told_from_missed_outside_and_false() -> None:
    said = made(
        ("cogging", "m", {"torque": 0.5, "order": 7.01}),
        ("viscous_damping", "m", {"damping": 0.1}),
        ("backlash", "m", {"gap": 0.1}),
    )
    found = rows(RIPPLE, said)
    assert [r.state for r in found] == ["outside", "not named", "not named", "false"]
    assert counts(found) == {"named": 1, "outside": 1, "false": 1} and ratio(said, "after") == 4.0
    right = made(
        ("cogging", "m", {"torque": 0.81, "order": 6.99}), ("cogging", "m", {"torque": 0.4, "order": 28.0})
    )
    assert [r.state for r in rows(RIPPLE, right)] == ["named", "named", "not named"]
    assert ratio(made(), "after") == 10.0, "what is not named has not lowered the error"


@pytest.mark.parametrize("worse", ["named", "outside", "false", "error"])
def test_a_machine_that_falls_behind_is_told(worse: str) -> None:
    said = made(("coulomb_friction", "m", {"torque": 0.5}), ("backlash", "m", {"gap": 0.1}))
    reached = {"named": 1, "outside": 0, "false": 1, "error": 4.1}
    held({**RIPPLE, "reached": reached}, said)
    step = {"named": 1, "outside": -1, "false": -1, "error": -0.5}[worse]
    with pytest.raises(AssertionError):
        held({**RIPPLE, "reached": {**reached, worse: reached[worse] + step}}, said)
    with pytest.raises(AssertionError):
        held({**RIPPLE, "reached": reached}, {"failed": "ValueError"})
