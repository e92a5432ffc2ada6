"""A load is named where inertia and weight were taken for it, and these where no load makes them."""

from __future__ import annotations

import pytest

from tests.diagnosis.rig import applied, asked, explored_from, node_with, recordings
from workbench.core import EffectKey
from workbench.diagnosis.explore import explore
from workbench.diagnosis.moves.order import ONE_BY_ONE
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

LEG = load_model("leg")
LOAD, SCALE = EffectKey("payload_mass", None), EffectKey("encoder_scale", "hip")
INERTIA, WEIGHT = EffectKey("linkage_inertia", None), EffectKey("linkage_gravity", None)


def test_a_load_in_place_of_its_inertia_and_its_weight() -> None:
    hidden = (
        HiddenEffect("payload_mass", parameters={"mass": 0.12}),
        HiddenEffect("encoder_scale", "hip", parameters={"scale": 0.9}),
    )
    problem = asked(LEG, *recordings(*hidden))
    begun = node_with(
        problem,
        applied(LEG, INERTIA, M11=0.0037, M12=0.005, M22=0.0069),
        applied(LEG, SCALE, scale=0.9),
        applied(LEG, WEIGHT, g1=0.2, g2=0.28),
        move=ONE_BY_ONE,
    )
    found, trace = explore(begun, problem)
    (merged,) = [t for t in trace if t.move == "one cause in place of two"]
    assert merged.taken and merged.begun_with == () and [key for key, _ in merged.added] == [LOAD, SCALE]
    values = {a.key: a.values for a in found.current.hypothesis.free}
    assert values.keys() == {LOAD, SCALE} and found.done
    assert values[LOAD]["mass"] == pytest.approx(0.12, rel=0.01)
    assert [step.added for step in found.steps] == [LOAD, SCALE], "where the first of the two was taken"
    errors = [problem.data.score(step.fit.mean_squares) for step in found.steps]
    assert errors[0] > 2.0 * errors[1]
    load, scale = found.steps
    assert 0.0 < load.removed_share < 0.999 and scale.removed_share > 0.9, (
        "each has its own share, not theirs"
    )
    assert load.ranking == ((LOAD, load.removed_share),)
    assert load.folds == scale.folds == (1, 1)


def test_inertia_and_weight_that_no_load_makes_stay() -> None:
    values = {"M11": 0.004, "M12": 0.001, "M22": 0.003}, {"g1": 0.05, "g2": 0.3}
    hidden = (
        HiddenEffect("linkage_inertia", parameters=values[0]),
        HiddenEffect("linkage_gravity", parameters=values[1]),
    )
    problem = asked(LEG, *recordings(*hidden))
    found = explored_from(problem, applied(LEG, INERTIA, **values[0]), applied(LEG, WEIGHT, **values[1]))
    assert {a.key for a in found.current.hypothesis.free} == {INERTIA, WEIGHT}
