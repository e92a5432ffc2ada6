"""Which effects are fitted for the next step: also what a promising refinement contains."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import workbench as wb
from tests.rotor import pushed, wandering
from workbench.core import EffectKey
from workbench.diagnosis.acceptance import at_noise_floor
from workbench.diagnosis.data import gather
from workbench.diagnosis.moves.trial_fits import SearchState, try_in_order
from workbench.diagnosis.problem import starting_fit
from workbench.diagnosis.screening.screen import screen
from workbench.diagnosis.screening.sensitivity import Linearisation

_DRY = EffectKey("coulomb_friction", "m")


def test_what_a_promising_refinement_contains_is_fitted(tmp_path: Path) -> None:
    """Where friction holds an axis at rest for long, a first estimate of plain friction is far too poor."""
    runs = [pushed(tmp_path, wandering(k), (8.0, 0.25), seed=k, friction=lambda w: 0.05) for k in range(2)]
    model = wb.load_model(str(tmp_path / "rotor.xml"))
    data, simulated = gather(model, runs, (), 0)
    start = starting_fit(model, data, simulated.clean)
    linearisation = Linearisation.of(model, data, start.simulated, len(runs))
    refinements = {"presliding_hysteresis", "stribeck_friction"}
    candidates = tuple(
        replace(c, test_loss=0.9 * start.test_loss) if c.key == _DRY else c
        for c in screen(linearisation, data)
        if c.key == _DRY or c.key.effect in refinements
    )
    assert {c.key.effect for c in candidates} == {_DRY.effect, *refinements}
    tried = try_in_order(SearchState(linearisation, candidates, start, data, False, lambda text: None))
    [(_, found)] = [(c, f) for c, f in tried if c.key == _DRY]
    assert at_noise_floor(found, data)
    [friction] = found.hypothesis.free
    assert friction.values["torque"] == pytest.approx(0.05, rel=0.05)
