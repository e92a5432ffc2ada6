"""Several of a kind in one place are one row of lists, and come apart again."""

from __future__ import annotations

from typing import Any

import pytest

from workbench.core import EffectKey, apart, together


def row(effect: str, copy: int = 1, **values: float) -> dict[str, Any]:
    parameters = {name: {"value": v, "std": 0.1 * v, "unit": "1"} for name, v in values.items()}
    kin = {"copy": copy} if copy > 1 else {}
    return {"effect": effect, "axis": "a", "location": "actuator", **kin, "parameters": parameters}


def test_copies_come_together_and_apart_in_their_order() -> None:
    rows = [row("cogging", order=7.0), row("viscous_damping", damping=1.0), row("cogging", 2, order=28.0)]
    whole = together(rows)
    assert [r["effect"] for r in whole] == ["cogging", "viscous_damping"]
    assert whole[0]["parameters"]["order"]["value"] == [7.0, 28.0] and "copy" not in whole[0]
    assert [(str(key), values["order"].value) for key, values in apart(whole[0])] == [
        ("cogging@a", 7.0),
        ("cogging@a#2", 28.0),
    ]


def test_what_corrects_one_number_twice_stays_two_rows() -> None:
    rows = [row("viscous_damping", damping=1.0), row("viscous_damping", damping=0.5)]
    assert together(rows) == rows


@pytest.mark.parametrize(
    "parameters",
    [
        {"order": {"value": [7.0, 28.0]}, "torque": {"value": 0.2}},
        {"order": {"value": [7.0, 28.0], "std": [0.1]}},
        {"order": {"value": []}},
    ],
)
def test_lists_of_other_lengths_are_refused(parameters: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="same number of values"):
        apart({"effect": "cogging", "axis": "a", "parameters": parameters})


def test_an_effect_without_parameters_and_an_open_deviation() -> None:
    assert apart({"effect": "linkage_inertia", "axis": None, "parameters": {}}) == [
        (EffectKey("linkage_inertia", None), {})
    ]
    ((_, values),) = apart(
        {"effect": "cogging", "axis": "a", "parameters": {"order": {"value": 7.0, "std": None}}}
    )
    assert values["order"].std == float("inf")
