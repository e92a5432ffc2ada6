"""One form for what any method answers, and what a model that has been given it scores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from workbench.comparison import compare
from workbench.core import Diagnosis, EffectKey, Estimate, Recording, SimulationError
from workbench.models import AppliedEffect, Model
from workbench.rigs import HiddenEffect

from .second.hidden import Hidden


@dataclass(frozen=True)
class Named:
    """One effect that was named.

    Attributes:
        key: which and where.
        parameters: name -> estimate.
        probability: that the name is right; None where the method does not say.
        also: what it says to be just as good.
    """

    key: EffectKey
    parameters: Mapping[str, Estimate] = field(default_factory=dict)
    probability: float | None = None
    also: tuple[EffectKey, ...] = ()


@dataclass(frozen=True)
class Answer:
    """What a method says of a case.

    Attributes:
        verdict: ``missing_effect``, ``partly_explained``, ``consistent`` or ``unexplained``.
        named: effects, best first; none with the last two.
        error_after: on the data that judge, with all that is named in the model; None if not known.
    """

    verdict: str
    named: tuple[Named, ...] = ()
    error_after: float | None = None


def answer_of(diagnosis: Diagnosis) -> Answer:
    """A diagnosis as an answer."""
    named = tuple(
        Named(f.key, f.parameters, f.probability, f.indistinguishable_from) for f in diagnosis.findings
    )
    last = diagnosis.findings[-1] if diagnosis.findings else None
    after = None if last is None else last.holdout_error_after
    if last is not None and after is None:
        after = last.error_after
    return Answer(diagnosis.verdict, named, after)


def key_of(hidden: HiddenEffect | Hidden) -> EffectKey:
    """The catalogue's name of what is hidden."""
    return EffectKey(hidden.effect, hidden.axis, hidden.location)


def with_truth(model: Model, hidden: Sequence[HiddenEffect | Hidden]) -> Model:
    """The model that has what is hidden, with the true parameters."""
    for each in hidden:
        parameters = dict(each.parameters)
        if each.effect == "backlash":  # the damping of flanks is a property of the model
            retardation = parameters.pop("damping", 0.0) / parameters["stiffness"]
            model = replace(model, flank_retardation_s=retardation)
        values = {name: Estimate(value, 0.0, "") for name, value in parameters.items()}
        model = model.with_effect(AppliedEffect(key_of(each), values))
    return model


def with_answer(model: Model, answer: Answer) -> Model:
    """The model with all that is named."""
    for each in answer.named:
        model = model.with_effect(AppliedEffect(each.key, each.parameters))
    return model


def error_of(model: Model, recordings: Sequence[Recording]) -> float | None:
    """`Comparison.error`; None where the model cannot run these recordings."""
    return errors_of(model, recordings)[0]


def errors_of(model: Model, recordings: Sequence[Recording]) -> tuple[float | None, float | None]:
    """`Comparison.error` and its noise floor; None where the model cannot run these recordings."""
    try:
        comparison = compare(model, recordings, draws=2)
    except SimulationError:
        return None, None
    return float(comparison.error), float(comparison.noise_error)
