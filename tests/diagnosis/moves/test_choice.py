"""Which of several explanations is taken."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.core import EffectKey, Estimate
from workbench.diagnosis.data import Data
from workbench.diagnosis.hypothesis import Fit, Hypothesis
from workbench.diagnosis.moves.choice import choose
from workbench.diagnosis.screening.candidate import Candidate
from workbench.effects import load_model
from workbench.models import AppliedEffect

_PLAIN, _REFINED = EffectKey("coulomb_friction", "knee"), EffectKey("presliding_hysteresis", "knee")
_PAYLOAD, _LINK = EffectKey("payload_mass", None, site="foot"), EffectKey("first_moment_error", "knee")
_BALL = {"mass": 0.1, "moment_x": 0.0, "moment_z": 0.01, "inertia": 0.001}
_HEAVIER = {"along": 0.01, "across": 0.0, "mass": 0.1}


def taken(*left: tuple[EffectKey, dict[str, float], float]) -> EffectKey:
    """Of effects with their values, each of which leaves so much of 100 by itself, the noise being 1."""
    recordings = (SimpleNamespace(valid=np.ones(10, bool)),)
    squares = np.ones((1, 2, 1))
    data = Data(recordings, 1, None, squares, 0.0 * squares, (), np.full((2, 1), 0.5**0.5))  # type: ignore[arg-type]
    helpful = []
    for key, values, loss in left:
        applied = AppliedEffect(key, {name: Estimate(x, 0.0, "") for name, x in values.items()})
        fit = Fit(Hypothesis(load_model("leg"), (applied,)), (), squares, loss, loss, np.zeros(0))
        helpful.append((Candidate(key, np.zeros(0), {}, loss), fit))
    return choose(helpful, (), 100.0, data)[0].key


@pytest.mark.parametrize(
    ("plain", "refined", "first"),
    [
        (30.0, 15.0, _PLAIN),  # something else may be missing that makes the difference
        (60.0, 15.0, _REFINED),
        (1.1, 1.1, _PLAIN),  # a tie is the simpler one's
    ],
)
def test_basic_effects_go_first(plain: float, refined: float, first: EffectKey) -> None:
    hysteresis = {"torque": 1.0, "stiffness": 10.0}
    assert taken((_PLAIN, {"torque": 1.0}, plain), (_REFINED, hysteresis, refined)) == first


@pytest.mark.parametrize(("values", "first"), [({"mass": 0.1}, _PAYLOAD), (_BALL, _LINK)])
def test_of_equals_the_form_with_fewer_numbers(values: dict[str, float], first: EffectKey) -> None:
    assert taken((_PAYLOAD, values, 1.1), (_LINK, _HEAVIER, 1.11)) == first
