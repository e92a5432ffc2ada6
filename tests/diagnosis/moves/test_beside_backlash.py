"""What else is missing where a gap is: all of it from the torque, before any loop is closed."""

from __future__ import annotations

import numpy as np
import pytest

from tests.diagnosis.rig import applied, asked, recordings
from workbench.core import EffectKey, SimulationError
from workbench.diagnosis.acceptance import nearly_at_floor
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.diagnosis.loss import floor_of_judging
from workbench.diagnosis.moves import beside_backlash as module
from workbench.diagnosis.moves.alternative_starts import what_the_torque_shows
from workbench.diagnosis.moves.beside_backlash import beside_gap
from workbench.diagnosis.moves.compliance_from_torque import plain_by_torque
from workbench.diagnosis.node import Way, with_stages
from workbench.diagnosis.problem import Quest
from workbench.diagnosis.screening.compliance import what_gives_way
from workbench.diagnosis.search_result import Stage
from workbench.effects import load_model
from workbench.models import Model
from workbench.rigs import HiddenEffect

LEG = load_model("leg")
KEY = EffectKey("backlash", "knee")
COULOMB, INERTIA = EffectKey("coulomb_friction", "knee"), EffectKey("linkage_inertia", None)
GAP = HiddenEffect("backlash", "knee", parameters={"gap": 0.004, "stiffness": 400.0})
FRICTION = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.2})
HEAVIER = HiddenEffect("linkage_inertia", None, parameters={"M11": 0.0, "M12": 0.0, "M22": 0.0012})


@pytest.fixture(scope="module")
def heavier() -> Quest:
    """What is asked of a leg with a gap and a heavier crank."""
    return asked(LEG, *recordings(GAP, HEAVIER))


def test_a_gap_is_found_with_what_hides_its_size(heavier: Quest) -> None:
    alone = what_gives_way(heavier.scene, heavier.data.training, 1.0)[0]
    assert alone.key == KEY
    gap, more = beside_gap(heavier.scene, alone, heavier.start, heavier.data.training)
    assert more.key == INERTIA and more.coefficients[2] == pytest.approx(0.0012, rel=0.05)
    off, off_alone = (abs(np.log(c.shape["stiffness"] / 400.0)) for c in (gap, alone))
    assert off < 0.05 and off_alone > 0.2
    assert gap.shape["gap"] == pytest.approx(0.004, rel=0.1)


def test_each_is_a_step_and_the_error_falls_with_all(heavier: Quest) -> None:
    stages = plain_by_torque(heavier.scene, heavier.data, heavier.start, heavier.progress)
    assert [s.added for s in stages] == [KEY, INERTIA]
    assert [{a.key for a in s.fit.hypothesis.free} for s in stages] == [{KEY}, {KEY, INERTIA}]
    assert all(s.ranking == ((s.added, s.removed_share),) for s in stages), "and no shares of the torque"
    assert stages[-1].fit.judged < 0.1 * heavier.start.judged
    before, floor = heavier.start.judged, floor_of_judging(heavier.data)
    for s in stages:
        assert s.removed_share == pytest.approx((before - s.fit.judged) / (before - floor))
        before = s.fit.judged


def test_a_gap_that_is_all_that_is_missing_stays_alone() -> None:
    quest = asked(LEG, *recordings(GAP))
    alone = what_gives_way(quest.scene, quest.data.training, 1.0)[0]
    assert beside_gap(quest.scene, alone, quest.start, quest.data.training) == [alone]


def test_of_what_does_about_as_well_the_simplest_is_taken() -> None:
    """Dry friction has many forms, and four parameters always leave a little less than one."""
    little = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.05})
    quest = asked(LEG, *recordings(GAP, little))
    alone = what_gives_way(quest.scene, quest.data.training, 1.0)[0]
    _, friction = beside_gap(quest.scene, alone, quest.start, quest.data.training)
    assert friction.key == COULOMB and friction.coefficients == pytest.approx([0.05], rel=0.1)


def test_what_no_body_can_be_is_not_proposed(heavier: Quest, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(model: Model) -> None:
        if any(e.key == INERTIA for e in model.effects):
            raise SimulationError("no body has such an inertia")

    monkeypatch.setattr(module, "compile_plant", refuse)
    alone = what_gives_way(heavier.scene, heavier.data.training, 1.0)[0]
    found = beside_gap(heavier.scene, alone, heavier.start, heavier.data.training)
    assert INERTIA not in {c.key for c in found} and found[0].key == KEY


def test_an_inertia_that_stood_for_a_gap_makes_room_for_it() -> None:
    """Friction hides the gap at first, and a rotor's inertia then stands for what is left of it."""
    quest = asked(LEG, *recordings(GAP, FRICTION, HEAVIER))
    assert all(c.judged > 0.1 for c in what_gives_way(quest.scene, quest.data.training, 1.0))
    friction = applied(LEG, COULOMB, torque=0.2)
    stand_in = applied(LEG, EffectKey("reflected_inertia", "knee"), inertia=0.0017)
    stages = []
    for free in ((friction,), (friction, stand_in)):
        (found,) = fit([Hypothesis(LEG, free)], quest.data)
        assert found is not None
        stages.append(Stage(free[-1].key, found, quest.data, 1.0, (), (), (), (), (), (1, 1), True))
    way = with_stages(Way(quest.start, quest.data), stages, 0)
    assert not way.done
    better = what_the_torque_shows(way, quest)
    assert nearly_at_floor(better.current, better.data)
    values = {a.key: a.values for a in better.current.hypothesis.free}
    assert set(values) == {KEY, COULOMB, INERTIA}
    assert values[COULOMB]["torque"] == pytest.approx(0.2, rel=0.03)
    assert values[INERTIA]["M22"] == pytest.approx(0.0012, rel=0.1)
    assert values[KEY]["gap"] == pytest.approx(0.004, rel=0.2)
