"""A sweep of the thresholds says which of them change an answer, the work, or nothing."""

from __future__ import annotations

from typing import Any

import policy_sweep
import pytest
from policy_sweep import Change, answer, table, values

from workbench.diagnosis.policy import POLICY, Policy

AS_IT_IS = Change()


def line(
    case: str, change: Change = AS_IT_IS, verdict: str = "consistent", work: float = 1e6
) -> dict[str, Any]:
    read = ["at_noise", "most_effects", "tie"]
    marks = {"verdict": verdict, "outcome": verdict, "good": verdict == "consistent", "named": []}
    return {"case": case, **marks, "work": work, **change._asdict(), "read": read}


def test_a_fifth_of_a_count_is_one_at_least() -> None:
    assert values("tie") == pytest.approx((0.024, 0.036))
    assert values("check_recordings") == (1, 3)
    assert values("budget_runs") == (160, 240)
    assert all(
        low < getattr(POLICY, name) < high
        for name in POLICY.__dataclass_fields__
        for low, high in [values(name)]
    )


def test_rows_for_what_changes_and_names_for_the_rest() -> None:
    low, high = values("at_noise")
    more, _ = values("most_effects")
    marks = [
        line("clean"),
        line("clean", Change("at_noise", low), "unexplained", 2e6),
        line("clean", Change("at_noise", high)),
        line("clean", Change("most_effects", more), work=1.5e6),
        *(line("clean", Change("tie", value)) for value in values("tie")),
    ]
    text = table(marks, ["at_noise", "most_effects", "tie", "shrunk"])
    assert f"| at_noise | {low:g} | 1 worse | 2.00 | clean: verdict consistent -> unexplained" in text
    assert f"| at_noise | {high:g} | none | 1.00 |" in text
    assert f"| most_effects | {more:g} | none | 1.50 |" in text
    assert "Changed nothing in 1 cases that read them: tie." in text
    assert "Never read there: shrunk." in text


def test_a_case_is_asked_with_the_value_and_tells_what_it_read(monkeypatch: pytest.MonkeyPatch) -> None:
    def marked(case: Any, others: Any, now: str, *, patience: float) -> dict[str, Any]:
        return {"case": case, "revision": now, "failed": f"at {POLICY.tie:g} of {POLICY.surest:g}"}

    monkeypatch.setattr(policy_sweep, "mark", marked)
    found = answer("one", Change("tie", 0.5), "now", 1.0)  # type: ignore[arg-type]
    assert found["failed"] == "at 0.5 of 0.98"
    assert (found["field"], found["value"], found["read"]) == ("tie", 0.5, ["surest", "tie"])
    assert Policy() == POLICY
