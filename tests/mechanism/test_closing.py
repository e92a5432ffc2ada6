"""Which of the closed postures assembly finds: what somebody chose goes before what the file states."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.importing.test_import import unequal_bars
from workbench.core import Mechanism
from workbench.mechanism import ClosedChain

_LIMITS = (-1.2, 1.2), (0.6, 1.6)
_AT = np.array([0.0, 1.1])  # hip and knee


def _leg(folder: Path) -> Mechanism:
    return Mechanism(
        unequal_bars(folder), ("hip", "crank"), ("hip", "knee"), (("below", "heel"),), None, limits=_LIMITS
    )


def _rest(leg: Mechanism, crank: float) -> tuple[tuple[str, float], ...]:
    """A closed posture, all joints of it, whose crank lies on the side of an angle."""
    chain = ClosedChain(replace(leg, start=(("hip", 0.0), ("knee", 1.1), ("crank", crank))))
    theta = chain.tree_position(chain.drive_position(_AT))
    return tuple(zip(chain.coordinates, map(float, theta), strict=True))


@pytest.mark.parametrize(("here", "there"), [(1.2, -1.6), (-1.6, 1.2)])
@pytest.mark.parametrize("more", [(), (("knee", 1.0),)])
def test_a_choice_goes_before_the_posture_of_the_file(
    tmp_path: Path, here: float, there: float, more: tuple[tuple[str, float], ...]
) -> None:
    leg = _leg(tmp_path)
    rest = replace(leg, rest=_rest(leg, here))
    chosen = replace(rest, start=(("crank", there), *more))
    assert np.sign(ClosedChain(rest).drive_position(_AT)[1]) == np.sign(here)
    assert np.sign(ClosedChain(chosen).drive_position(_AT)[1]) == np.sign(there)


def test_a_rod_alone_chooses_a_drive_that_goes_with_it(tmp_path: Path) -> None:
    leg = _leg(tmp_path)
    here, there = (dict(_rest(leg, crank)) for crank in (1.2, -1.6))
    chosen = replace(leg, rest=tuple(here.items()), start=(("pin", there["pin"]),))
    assert ClosedChain(chosen).drive_position(_AT)[1] == pytest.approx(there["crank"], abs=1e-6)


def test_a_choice_leaves_what_it_does_not_touch_at_rest(tmp_path: Path) -> None:
    leg = _leg(tmp_path)
    rest = dict(_rest(leg, 1.2))
    chain = ClosedChain(replace(leg, rest=tuple(rest.items()), start=(("crank", -1.6),)))
    found = dict(zip(chain.coordinates, chain.assembled, strict=True))
    assert abs(found["hip"] - rest["hip"]) < 0.3 and abs(found["knee"] - rest["knee"]) < 0.3
