"""How sure a finding is, what it could be instead, and what is said of causes that may not be named."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from workbench.core import EffectKey, Estimate
from workbench.diagnosis.findings import _probability, near_line, step_of
from workbench.diagnosis.search_result import AcceptedStep

_HIP, _KNEE = EffectKey("coulomb_friction", "hip"), EffectKey("coulomb_friction", "knee")
_DAMPED = EffectKey("viscous_damping", "hip")


def told(*added: EffectKey, indistinguishable: tuple[EffectKey, ...]) -> tuple[float, tuple[EffectKey, ...]]:
    """The chance of friction on the hip, and what looks the same, where the final model has `added`."""
    free = tuple(SimpleNamespace(key=k, parameters={}) for k in added)
    fit: Any = SimpleNamespace(hypothesis=SimpleNamespace(added=free), mean_squares=None)
    none: Any = None
    ratios = tuple((k, 1.0) for k in indistinguishable)
    told = {"indistinguishable": indistinguishable, "loss_ratios": ratios}
    step = AcceptedStep(_HIP, fit, none, 1.0, (1, 1), True, **told)
    found: Any = SimpleNamespace(
        model=None,
        steps=(step,),
        final=fit,
        consistent_after=True,
        explained=1.0,
        adequacy={},
        start_data=SimpleNamespace(score=lambda *_, **__: 0.0),
    )
    shown = step_of(0, found, None, {_HIP: ("a line",)})
    return _probability(step, found, shown.indistinguishable_from), shown.indistinguishable_from


def test_what_does_as_well_makes_a_name_doubtful() -> None:
    chance, alike = told(_HIP, indistinguishable=(_DAMPED,))
    assert chance == pytest.approx(0.784)
    assert alike == (_DAMPED,)


@pytest.mark.parametrize(
    "form", ["coulomb_friction", "stribeck_friction"], ids=["the same", "a form of the same"]
)
def test_a_second_cause_is_no_other_name_for_the_first(form: str) -> None:
    chance, alike = told(_HIP, _KNEE, indistinguishable=(EffectKey(form, "knee"),))
    assert chance == pytest.approx(0.98)
    assert alike == ()


def found(explained: float, tests_on_holdout: bool = False) -> Any:
    one = SimpleNamespace(key=_HIP, parameters={"torque": Estimate(0.5, 0.01, "N*m")})
    end = SimpleNamespace(hypothesis=SimpleNamespace(added=(one,)))
    data = SimpleNamespace(tests_on_holdout=tests_on_holdout)
    return SimpleNamespace(explained=explained, final=end, start_data=data)


def test_a_share_that_is_not_enough_does_not_read_as_if_it_were() -> None:
    (line,) = near_line("unexplained", found(0.9463))
    assert "it removes 94 %" in line


@pytest.mark.parametrize(
    ("held_out", "said"), [(True, "the held-out recordings"), (False, "the fitted recordings")]
)
@pytest.mark.parametrize("explained", [0.6, 0.9])
def test_a_share_that_is_told_says_of_which_data_it_is(explained: float, held_out: bool, said: str) -> None:
    (line,) = near_line("unexplained", found(explained, held_out))
    assert said in line and ("held-out" in line) is held_out


@pytest.mark.parametrize(("explained", "said"), [(0.68, ["not enough to name one"]), (0.1, [])])
def test_less_has_no_name_and_hardly_anything_no_line(explained: float, said: list[str]) -> None:
    lines = near_line("unexplained", found(explained))
    assert len(lines) == len(said) and all(s in line for s, line in zip(said, lines, strict=True))
