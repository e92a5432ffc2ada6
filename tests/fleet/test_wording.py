"""What a fleet's table and page say."""

from __future__ import annotations

from workbench.fleet.wording import findings


def test_findings_say_where_they_sit() -> None:
    value = {"torque": {"value": 0.25, "std": 0.01, "unit": "N*m"}}
    places = ("knee", "actuator"), ("knee", "joint"), (None, "actuator")
    found = [{"effect": "x", "axis": a, "location": place, "parameters": {}} for a, place in places]
    found[1]["parameters"] = value
    lines = findings({"failed": None, "diagnosis": {"findings": found}})
    assert lines == ["X on the knee drive", "X at the knee joint: torque 0.250 ± 0.020 N m", "X on all axes"]
