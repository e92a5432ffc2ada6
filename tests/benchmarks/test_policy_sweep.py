"""A sweep of the thresholds says which of them change an answer, the work, or nothing."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import policy_sweep
import pytest
from policy_sweep import Change, answer, sweep, table, values

from workbench.diagnosis.policy import POLICY, Policy

AS_IT_IS = Change()


def line(
    case: str,
    change: Change = AS_IT_IS,
    verdict: str = "consistent",
    work: float = 1e6,
    **notes: list[list[Any]],
) -> dict[str, Any]:
    read = ["at_noise", "most_effects", "tie"]
    marks = {"verdict": verdict, "outcome": verdict, "good": verdict == "consistent", "named": []}
    own = {"case": case, **marks, "work": work, **change._asdict(), "cpu_s": work / 1e6}
    none: dict[str, list[list[Any]]] = {"flips": [], "escapes": []}
    return own | ({"read": read, "one_way": ["tie"], **none, **notes} if change.field is None else {})


def test_a_fifth_of_a_count_is_one_at_least() -> None:
    assert values("tie") == pytest.approx((0.024, 0.036))
    assert values("check_recordings") == (1, 3)
    assert values("budget_runs") == (160, 240)
    assert all(
        low < getattr(POLICY, name) < high
        for name in POLICY.__dataclass_fields__
        for low, high in [values(name)]
    )


def test_rows_for_what_may_change_and_names_for_the_rest() -> None:
    low, high = values("at_noise")
    few, more = values("most_effects")
    marks = [
        line("clean", flips=[["at_noise", low, "a.py:1"]], escapes=[["most_effects", more, "b.py:1"]]),
        line("pair", flips=[["at_noise", low, "a.py:1"], ["at_noise", high, "a.py:1"]]),
        line("clean", Change("at_noise", low), "unexplained", 2e6),
        line("pair", Change("at_noise", high)),
        line("clean", Change("most_effects", more), work=1.5e6),
    ]
    text = table(marks, ["most_effects", "at_noise", "tie", "shrunk"])
    assert text.index("| at_noise | 2 | 2/1 | 0/0 | 1/1 | 1 worse | 2.00/1.00 |") < text.index(
        "| most_effects | 2 | 0/0 | 0/1 | 0/1 | same | /1.50 |"
    )
    assert f"- at_noise {low:g}, clean, worse: verdict consistent -> unexplained" in text
    assert "Decide nothing in 2 cases: tie." in text
    assert "always with the same outcome (2 cases): tie." in text
    assert "Never read there: shrunk." in text
    assert few < more


def test_a_case_is_asked_with_the_value_and_tells_another(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def marked(case: Any, others: Any, now: str, *, patience: float) -> dict[str, Any]:
        slow = POLICY.tie > 0.035
        return {"case": case, "revision": now, "failed": f"at {POLICY.tie:g} of {POLICY.surest:g}: {slow}"}

    monkeypatch.setattr(policy_sweep, "mark", marked)
    found = answer("one", AS_IT_IS, "now", 1.0)  # type: ignore[arg-type]
    assert found["failed"] == "at 0.03 of 0.98: False"
    assert (found["field"], found["read"], found["escapes"]) == (None, ["surest", "tie"], [])
    ((name, value, _),) = found["flips"]
    assert (name, value) == ("tie", values("tie")[1])
    again = answer("one", Change(name, value), "now", 1.0)  # type: ignore[arg-type]
    assert again["failed"] == "at 0.036 of 0.98: True"
    assert Policy() == POLICY


def test_only_what_may_change_is_asked_again_and_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[tuple[str, str | None]] = []

    def marked(case: Any, change: Change, now: str, patience: float) -> dict[str, Any]:
        asked.append((case.name, change.field))
        flips = [["tie", values("tie")[0], "a.py:1"], ["surest", values("surest")[1], "a.py:2"]]
        return line(case.name, change, work=1e6 * len(case.name), flips=flips[: len(case.name) - 3])

    monkeypatch.setattr(policy_sweep, "answer", marked)
    cases: Any = [SimpleNamespace(name=name) for name in ("longer", "pair")]
    sweep(cases, ["tie", "surest"], tmp_path / "lines", 1, 1.0, most=1)
    sweep(cases, ["tie", "surest"], tmp_path / "lines", 1, 1.0)
    assert asked[:2] == [("longer", None), ("pair", None)]
    assert asked[2:] == [("pair", "tie"), ("longer", "surest"), ("longer", "tie")]
