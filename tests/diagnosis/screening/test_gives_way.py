"""A spring and a gap are told from the torque alone; `test_compliance` asks it of every place, and more."""

from __future__ import annotations

import pytest

from workbench.rigs import HiddenEffect

from .test_compliance import check_told, str_of

#: Other sizes than there.
HIDDEN = [
    HiddenEffect("joint_compliance", "knee", parameters={"stiffness": 150.0, "damping": 0.2}),
    HiddenEffect("backlash", "knee", parameters={"gap": 0.012, "stiffness": 320.0, "damping": 0.6}),
]


@pytest.mark.parametrize("hidden", HIDDEN, ids=str_of)
def test_what_gives_way_is_told_with_its_numbers(hidden: HiddenEffect) -> None:
    check_told(hidden)
