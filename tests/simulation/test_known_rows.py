"""Rows at which the torque that a model lacks is known."""

from __future__ import annotations

import numpy as np
import pytest

from tests.simulation.make import having
from workbench.core import EffectKey
from workbench.effects import compile_plant, load_model
from workbench.simulation.known_rows import edge_rows, known_rows

LEG = load_model("leg")
STEP = 0.002
EDGE = 50


def speeds() -> np.ndarray:
    """The hip swings on, the knee stands still for a fifth of the time."""
    time = STEP * np.arange(1000)
    out = np.stack([1.0 + np.sin(5.0 * time), np.cos(5.0 * time)], axis=1)
    out[400:600, 1] = 0.0
    return out


def test_ends_where_differentiating_errs_are_not_known() -> None:
    known = known_rows(compile_plant(LEG), speeds(), STEP)
    assert edge_rows(1000, STEP) == EDGE
    assert not known[:EDGE].any() and not known[-EDGE:].any() and known[EDGE:-EDGE].all()


@pytest.mark.parametrize(("location", "drives"), [("actuator", [1]), ("joint", [0, 1])])
def test_friction_at_rest_hides_the_torque_of_what_turns_there(location: str, drives: list[int]) -> None:
    """At the knee's pin, which both drives turn, it is a torque on both."""
    stiff = having(LEG, EffectKey("coulomb_friction", "knee", location), torque=0.3)
    speed = speeds()
    if location == "joint":  # the pin rests while both drives turn alike
        speed[400:600, 1] = speed[400:600, 0]
    known = known_rows(compile_plant(stiff), speed, STEP)[410:590]
    assert [k for k in range(2) if not known[:, k].any()] == drives
    assert all(known[:, k].all() for k in range(2) if k not in drives)
