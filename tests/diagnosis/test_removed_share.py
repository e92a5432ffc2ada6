"""What an effect removes is one share, of the squared error above the noise, wherever it is told."""

from __future__ import annotations

import pytest

from workbench.core import EffectKey
from workbench.diagnosis.evidence.residual_evidence import finding_lines
from workbench.diagnosis.loss import test_noise_floor as noise_floor
from workbench.diagnosis.moves.add import next_step
from workbench.diagnosis.removed_share import removed_share, removed_shares
from workbench.diagnosis.screening.screen import screen
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

from .rig import asked, recordings

FRICTION = EffectKey("coulomb_friction", "knee")


def test_it_is_of_what_stands_above_the_noise() -> None:
    assert removed_share(5.0, 3.0, 1.0) == pytest.approx(0.5)
    assert removed_share(5.0, 1.0, 1.0) == pytest.approx(1.0), "all of it, where noise alone is left"
    assert removed_share(5.0, 5.0, 1.0) == 0.0
    assert removed_share(5.0, 7.0, 1.0) == pytest.approx(-0.5)
    one, other = EffectKey("viscous_damping", "hip"), FRICTION
    shares = removed_shares(5.0, [(one, 4.0), (other, 2.0)], 1.0)
    assert [k for k, _ in shares] == [other, one] and [s for _, s in shares] == pytest.approx([0.75, 0.25])


def test_a_step_its_ranking_and_its_evidence_have_the_same_share() -> None:
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.02})
    problem = asked(load_model("leg"), *recordings(hidden))
    screened, _ = screen(problem.linearisation, problem.data, problem.start.simulated, ())
    step = next_step(problem.linearisation, screened, problem.start, problem.data, problem.progress)
    assert step is not None and step.added == FRICTION
    before, floor = problem.start.test_loss, noise_floor(problem.data)
    assert step.removed_share == pytest.approx((before - step.fit.test_loss) / (before - floor))
    assert step.removed_share > 1.0 - step.fit.test_loss / before, (
        "the noise is no error that could be removed"
    )
    assert dict(step.ranking)[FRICTION] == pytest.approx(step.removed_share, abs=0.01), "but for polishing"
    (applied,) = step.fit.hypothesis.added
    shown = 100.0 * min(step.removed_share, 1.0)
    told = finding_lines(step, applied)[0]
    assert told.startswith(f"removes {shown:.1f} % of the squared error above the noise")
