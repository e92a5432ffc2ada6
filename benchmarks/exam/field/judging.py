"""What else a case of the field asks of an answer: values within a tenth, and the verdict on the rest."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from workbench.core import Diagnosis

from .plant import Field, has

WITHIN = 0.1  # of the machine's number, or of what the file lacks of it if that is more
#: Of the squared error above the noise: what may stay where nearly all is explained.
NEARLY_ALL = 0.05


def judged(case: Field, kind: str, line: Mapping[str, Any], diagnosis: Diagnosis) -> dict[str, Any]:
    """What a field case adds to the marks in `line`, ``good`` among it.

    ``disagreeing``: effects that recordings have of different size; ``wanted``: verdicts that are true of
    the case; ``within``: of each value of a right name whether it is within `WITHIN`, by "effect@axis name".
    """
    disagreeing = [str(each.key) for each in diagnosis.disagreeing]
    if kind == "two_units":
        outcome = "disagreeing" if disagreeing else line["outcome"]
        good = bool(disagreeing) and not line["findings"]
        return {"disagreeing": disagreeing, "outcome": outcome, "good": good, "within": {}, "wanted": []}
    within = _within(case, line)
    wanted = _wanted(kind, line)
    good = line["good"] and all(within.values())
    good = good and (line["verdict"] in wanted or not line["visible"]) and not disagreeing
    return {"disagreeing": disagreeing, "good": good, "within": within, "wanted": wanted}


def refused(kind: str, problem: str) -> dict[str, Any]:
    """Marks of what was refused in one line: right where recordings do not go together and it says so."""
    if kind != "two_units" or not any(word in problem for word in ("unit", "disagree", "load")):
        return {"failed": f"diagnosis: {problem}"}
    return {
        "verdict": "refused",
        "outcome": "refused",
        "good": True,
        "visible": True,
        "evidence": [problem],
        "findings": [],
        "false_findings": 0,
        "first_right": False,
        "floor": None,
        "removed": None,
        "others": {},
    }


def _within(case: Field, line: Mapping[str, Any]) -> dict[str, bool]:
    machine, found = case.machine, {}
    for finding in line["findings"]:
        if finding["is"] != "right":
            continue
        truth = {name: p["truth"] or 0.0 for name, p in finding["parameters"].items()}
        lacks = {name: abs(value) for name, value in truth.items()}
        mass = max(lacks.pop("mass", 0.0), machine.links[machine.index(finding["axis"])].mass)
        others = max(*lacks.values(), abs(has(machine, finding["effect"], finding["axis"])))
        for name, p in finding["parameters"].items():
            size = mass if name == "mass" else others
            found[f"{finding['key']} {name}"] = bool(abs(p["value"] - truth[name]) <= WITHIN * size)
    return found


def _wanted(kind: str, line: Mapping[str, Any]) -> list[str]:
    if kind == "clean":
        return ["consistent"]
    if kind != "beside_stranger":
        return ["missing_effect"]
    noise = line["floor_noise"]
    stays = (line["floor"] ** 2 - noise**2) / max(line["before"] ** 2 - noise**2, 1e-30)
    # at the border either is true
    return ["partly_explained"] * (stays > 0.5 * NEARLY_ALL) + ["missing_effect"] * (stays < 2 * NEARLY_ALL)
