"""Which of several explanations is taken."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.core import EffectKey
from workbench.diagnosis.data import Data
from workbench.diagnosis.moves.choice import choose
from workbench.diagnosis.screening.candidate import Candidate
from workbench.effects import load_model

_PLAIN, _REFINED = EffectKey("coulomb_friction", "knee"), EffectKey("presliding_hysteresis", "knee")


def taken(plain: float, refined: float) -> EffectKey:
    """Of friction that leaves `plain` of 100, and its refinement, by itself the noise being 1."""
    recordings = (SimpleNamespace(valid=np.ones(10, bool)),)
    squares = np.ones((1, 2, 1))
    data = Data(recordings, 1, None, squares, 0.0 * squares, (), np.full((2, 1), 0.5**0.5))  # type: ignore[arg-type]
    helpful = [
        (Candidate(key, np.zeros(0), {}, left), SimpleNamespace(test_loss=left, training_loss=left))
        for key, left in ((_PLAIN, plain), (_REFINED, refined))
    ]
    return choose(helpful, (), 100.0, data, load_model("leg"))[0].key  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("plain", "refined", "first"),
    [
        (30.0, 15.0, _PLAIN),  # something else may be missing that makes the difference
        (60.0, 15.0, _REFINED),
        (1.1, 1.1, _PLAIN),  # a tie is the simpler one's
    ],
)
def test_basic_effects_go_first(plain: float, refined: float, first: EffectKey) -> None:
    assert taken(plain, refined) == first
