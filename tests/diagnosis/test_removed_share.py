"""What an effect removes is one share, of the squared error above the noise, wherever it is told."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from workbench.core import EffectKey
from workbench.diagnosis.evidence.residual_evidence import finding_lines
from workbench.diagnosis.loss import test_noise_floor as noise_floor
from workbench.diagnosis.moves.add import next_step
from workbench.diagnosis.removed_share import HeldOutFall, removed_share, removed_shares, shown
from workbench.diagnosis.screening.screen import screen
from workbench.effects import load_model
from workbench.models import AppliedEffect
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


def test_a_step_its_ranking_and_evidence_have_the_same_share() -> None:
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.02})
    problem = asked(load_model("leg"), *recordings(hidden))
    screened = screen(problem.linearisation, problem.data)
    step = next_step(problem.linearisation, screened, problem.start, problem.data, problem.progress)
    assert step is not None and step.added == FRICTION
    before, floor = problem.start.test_loss, noise_floor(problem.data)
    assert step.removed_share == pytest.approx((before - step.fit.test_loss) / (before - floor))
    assert step.removed_share > 1.0 - step.fit.test_loss / before, (
        "the noise is no error that could be removed"
    )
    assert dict(step.ranking)[FRICTION] == pytest.approx(step.removed_share, abs=0.01), "but for polishing"
    (applied,) = step.fit.hypothesis.added
    told = finding_lines(step, applied)[0]
    assert told.startswith(f"removes {shown(step.removed_share)} of the squared error above the noise on ")


def accepted(by_holdout: bool, folds: tuple[int, int] = (1, 1)) -> Any:
    """A step of which only what is told matters."""
    return SimpleNamespace(
        by_holdout=by_holdout, folds=folds, removed_share=0.93, ranking=((EffectKey("lag", "hip"), 0.5),),
        indistinguishable=(), fit=SimpleNamespace(hypothesis=SimpleNamespace(model=load_model("leg"))),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (0.13, 0.0673, "removes 82.7 % of"),
        (0.13, 0.04, "removes all of"),
        (0.13, 0.04401, "removes more than 99.9 % of"),
        (0.13, 0.044, "removes all of"),
        (0.13, 0.2, "adds 154.4 % to"),
        (0.13, 0.15, "adds 37.4 % to"),
        (0.0454, 0.044, "cannot test it: their error is only 1.03 times the noise"),
    ],
)
def test_held_out_recordings_have_the_share_beside_it(before: float, after: float, said: str) -> None:
    line = HeldOutFall(before, after, 0.044).line
    assert said in line and "held-out recordings" in line


@pytest.mark.parametrize(
    ("folds", "by_holdout", "said"),
    [
        ((1, 1), True, "lowers the error on the held-out recording"),
        ((0, 1), True, "does not lower the error on the held-out recording"),
        ((3, 3), True, "lowers the error on all 3 held-out recordings"),
        ((4, 5), False, "lowers the error on 4 of 5 such parts"),
    ],
)
def test_it_is_said_where_the_error_falls(folds: tuple[int, int], by_holdout: bool, said: str) -> None:
    assert said in finding_lines(accepted(by_holdout, folds), AppliedEffect(FRICTION, {}))


def test_what_helps_with_others_only_is_said_to_do_so() -> None:
    fall, applied = HeldOutFall(0.275, 0.51, 0.0445), AppliedEffect(FRICTION, {})
    alone = finding_lines(accepted(True), applied, (FRICTION,), fall)
    assert "adds 250.5 % to" in alone[0] and "lowers the error on the held-out recording" in alone
    both = finding_lines(accepted(True), applied, (FRICTION, EffectKey("lag", "knee")), fall)
    assert both[0] == "lowers the error only together with the other effects that were found"
    assert not [line for line in both if "adds" in line or "held-out recording" in line.split("(")[0]]


@pytest.mark.parametrize("by_holdout", [True, False])
def test_every_share_names_its_data(by_holdout: bool) -> None:
    judged = (
        "on held-out recordings"
        if by_holdout
        else "on parts of the recordings, each left out of the fit in turn"
    )
    step = accepted(by_holdout)
    fall = HeldOutFall(0.13, 0.0673, 0.044)
    shares = [
        line for line in finding_lines(step, AppliedEffect(FRICTION, {}), (), fall) if "removes" in line
    ]
    assert shares[0] == fall.line
    assert [
        f"removes 93.0 % of the squared error above the noise {judged}" in line for line in shares[1:-1]
    ] == ([] if by_holdout else [True])
    assert "removes 50.0 %; this effect removes 93.0 %" in shares[-1] and judged in shares[-1]
