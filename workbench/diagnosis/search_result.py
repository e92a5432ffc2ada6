"""The result of a search: accepted steps from start to end."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from workbench.comparison import Simulated
from workbench.core import Disagreement, EffectKey, Identifiability, Stopped, Tried
from workbench.models import AppliedEffect, Model

from .adequacy.adequacy import Adequacy
from .data import Data
from .hypothesis import Fit
from .loss import test_noise_floor
from .moves.choice import same_cause
from .removed_share import removed_share
from .screening.candidate import Candidate
from .screening.linear_problem import Linear


@dataclass(frozen=True)
class AcceptedStep:
    """One accepted effect, with the fit that includes it.

    Attributes:
        added: the effect.
        fit: model with it and all earlier ones, refitted.
        data: recordings with the noise floor of that model.
        removed_share: share of the excess squared error before that it removed (`removed_share`).
        folds: number of folds that improved, and of all.
        by_holdout: whether the test loss was that of held-out recordings.
        indistinguishable: effects that fit as well, with no fewer free parameters.
        others: models with the best other explanations in place of it, best first.
        dropped: earlier effects that it made needless.
        ranking: the same share of every simulated candidate by itself, best first.
        loss_ratios: other explanations with their test loss over this one's, best first.
        runs: the model's runs, without and with noise; filled in when the step is accepted.
    """

    added: EffectKey
    fit: Fit
    data: Data
    removed_share: float
    folds: tuple[int, int]
    by_holdout: bool
    indistinguishable: tuple[EffectKey, ...] = ()
    others: tuple[tuple[EffectKey, Model], ...] = ()
    dropped: tuple[EffectKey, ...] = ()
    ranking: tuple[tuple[EffectKey, float], ...] = ()
    loss_ratios: tuple[tuple[EffectKey, float], ...] = ()
    runs: Simulated | None = None

    @staticmethod
    def between(before: Fit, found: Fit, added: EffectKey, data: Data, **told: Any) -> AcceptedStep:
        """Return the step from one fit to a fit with one more effect, with further facts about the step."""
        share = removed_share(before.test_loss, found.test_loss, test_noise_floor(data))
        folds = int(np.sum(found.fold_losses < before.fold_losses)), len(found.fold_losses)
        return AcceptedStep(added, found, data, share, folds, data.tests_on_holdout, **told)

    def indistinguishable_at(self, end: Fit) -> tuple[EffectKey, ...]:
        """Return indistinguishable effects, without those that are in the final fit in any form."""
        return tuple(key for key in self.indistinguishable if not has_cause(end, key))


def steps_through(
    before: Fit,
    found: Iterable[tuple[EffectKey, Fit]],
    data: Data,
    told: Callable[[EffectKey], dict[str, Any]] = lambda key: {},
) -> tuple[AcceptedStep, ...]:
    """Steps from a fit through others, each with one more effect; `told` holds further facts about each."""
    steps = []
    for key, fit in found:
        steps.append(AcceptedStep.between(before, fit, key, data, **told(key)))
        before = fit
    return tuple(steps)


def has_cause(found: Fit, key: EffectKey) -> bool:
    """Return whether a fit includes a cause in some form."""
    return any(same_cause(key, applied.key) for applied in found.hypothesis.added)


@dataclass(frozen=True)
class SearchResult:
    """The result of a search: data and fit at the start, accepted steps, first screening, and why it ended.

    `explained` is the share of the excess squared error that is gone; `median_explained` is the same for the
    median recording, where trajectories of the final model diverge (else 0). `adequacy` has the effects that
    are certain although something else is missing; `near` those that help beside them and are not certain.
    `identifiability` and `disagreeing` say what the recordings can tell apart and where they contradict each
    other, before any search. `jointly`: whether all axes were solved together.
    `linear`: the linear problem of all effects that this is read off. `trace`: what was tried.
    `are_the_laws`: whether the effects are not merely close to the laws of what is missing. `by_links`: the
    share of what they leave that errors of the masses of all links together explain; 0 where it is no most.
    `of_links`: whether several of these are wrong for certain, so that no other effect is searched for.
    """

    model: Model
    start: Fit
    start_data: Data
    start_runs: Simulated
    steps: tuple[AcceptedStep, ...]
    screened: tuple[Candidate, ...]
    consistent_before: bool
    consistent_after: bool
    explained: float
    median_explained: float = 0.0
    adequacy: Mapping[EffectKey, Adequacy] = field(default_factory=dict)
    near: tuple[AppliedEffect, ...] = ()
    identifiability: Identifiability | None = None
    disagreeing: tuple[Disagreement, ...] = ()
    jointly: bool = False
    linear: Linear | None = None
    trace: tuple[Tried, ...] = ()
    are_the_laws: bool = True
    by_links: float = 0.0
    of_links: bool = False

    @property
    def stopped(self) -> Stopped:
        """Why the search ended: noise explains the rest, the budget was spent, or nothing more helps."""
        if self.consistent_before or self.consistent_after:
            return "noise"
        return "budget" if self.start_data.budget.spent else "nothing_helps"

    @property
    def final(self) -> Fit:
        """Return the last accepted fit."""
        return self.steps[-1].fit if self.steps else self.start

    @property
    def final_data(self) -> Data:
        """Return the recordings with the noise floor of the last accepted model."""
        return self.steps[-1].data if self.steps else self.start_data
