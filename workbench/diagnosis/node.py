"""Nodes of the search: a fit, the steps that led to it, and the error left there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from workbench.comparison import Scale, Simulated
from workbench.comparison.consistent import consistent
from workbench.core import EffectKey, SimulationError
from workbench.models import AppliedEffect

from .adequacy.adequacy import Adequacy
from .data import Data
from .fitting.divergence import divergence
from .fitting.fit import fit
from .hypothesis import Fit
from .loss import explained, median_explained, rescored
from .may_be_named import are_several, may_be_named
from .policy import POLICY
from .problem import Problem
from .screening.candidate import Candidate
from .screening.sensitivity import Linearisation
from .screening.stiction import candidates
from .search_result import AcceptedStep


@dataclass(frozen=True)
class Growth:
    """The rules by which effects are added to a node one at a time.

    Attributes:
        most: number of effects to add; None: as many as the problem allows.
        through_divergence: go on where trajectories diverge; the divergence is then measured at the end.
    """

    most: int | None = None
    through_divergence: bool = False


@dataclass(frozen=True, eq=False)
class Node:
    """A node of the search.

    Attributes:
        current: the fit.
        data: the recordings with the noise floor of its model.
        steps: the accepted steps that led to it.
        done: whether noise explains the rest.
        move: name of the move that proposed it.
        growth: how more effects are added to it; None where none are.
        bold: whether it began with something that no data had confirmed by itself: it has to explain more.
        as_good: whether it does as well as the node that it was made from, by the rule of its move.
        jointly: whether its effects were solved for together along the measured motion.
        adequacy: how each effect of a joint solution stands that is certain although more is missing.
        near: effects of a joint solution that help and are not certain.
        by_links: the share of what it leaves that several wrong numbers of links explain together; 0 where
            that is not shown.
        enough: whether nothing has to be searched one by one beside it.
    """

    current: Fit
    data: Data
    steps: tuple[AcceptedStep, ...] = ()
    done: bool = False
    move: str = ""
    growth: Growth | None = None
    bold: bool = False
    as_good: bool = False
    jointly: bool = False
    adequacy: Mapping[EffectKey, Adequacy] = field(default_factory=dict)
    near: tuple[AppliedEffect, ...] = ()
    by_links: float = 0.0
    enough: bool = False

    def begun(self, **changes: Any) -> Node:
        """Return a copy of this node for a move to change, without the facts noted about this one."""
        return Node(self.current, self.data, self.steps, self.done, **changes)

    @cached_property
    def may_be_named(self) -> bool:
        """Return whether its effects may be named if they explain the recordings."""
        return may_be_named(self.current, self.data, self.adequacy)

    @property
    def has_several_certain(self) -> bool:
        """Return whether a joint solution has several effects that are certain though more is missing."""
        return self.jointly and not self.done and are_several([step.added for step in self.steps])

    @property
    def keys(self) -> frozenset[EffectKey]:
        """Return the keys of its effects."""
        return self.current.hypothesis.keys

    @property
    def size(self) -> int:
        """Return the number of its free parameters."""
        return self.current.hypothesis.size

    @property
    def diverges(self) -> bool:
        """Return whether trajectories of its model diverge for small parameter changes."""
        return self.current.hypothesis.diverges


def effect_keys(found: Fit) -> frozenset[EffectKey]:
    """Return the keys of the effects of a fit."""
    return found.hypothesis.keys


def screened_at(current: Fit, data: Data, problem: Problem) -> tuple[Linearisation, Sequence[Candidate]]:
    """Return the linearisation about a fit, and every effect screened there."""
    linearisation = linearisation_at(current, data, problem)
    return linearisation, candidates(linearisation, current, data, problem.seed)


def linearisation_at(current: Fit, data: Data, problem: Problem) -> Linearisation:
    """Return the linearisation about a fit, from the cache if the same runs were linearised before."""
    if not current.hypothesis.added:
        return problem.linearisation
    for linearisation in problem.linearisations:
        if all(a is b for a, b in zip(linearisation.runs, current.simulated, strict=True)):
            return linearisation
    linearisation = Linearisation.of(current.hypothesis.model, data, current.simulated, len(data.recordings))
    problem.linearisations.appendleft(linearisation)
    return linearisation


def rest_without(current: Fit, keys: Sequence[EffectKey], data: Data) -> tuple[Fit, Linearisation] | None:
    """Return the fit of the other effects when some are taken out, and the linearisation about it; None if
    the model without them does not run.
    """
    hypothesis = current.hypothesis
    for key in keys:
        hypothesis = hypothesis.without(key)
    (rest,) = fit([hypothesis], data, iterations=1)
    if rest is None:
        return None
    return rest, Linearisation.of(rest.hypothesis.model, data, rest.simulated, len(data.recordings))


def node_after(steps: tuple[AcceptedStep, ...], problem: Problem) -> Node:
    """Return the node after some first steps; the start if there are none."""
    if not steps:
        return Node(problem.start, problem.data)
    data = steps[-1].data
    return Node(rescored(steps[-1].fit, data), data, steps)


def explained_share(node: Node, problem: Problem) -> float:
    """The share of the excess at the start that a node explains; of the median recording if runs diverge."""
    ends = problem.data, problem.start, node.current, node.data
    return max(explained(*ends), median_explained(*ends) if node.diverges else 0.0)


def explains_data(node: Node, problem: Problem) -> bool:
    """Return whether the effects of a node explain the data."""
    if node.done or not node.steps:
        return node.done
    return explained_share(node, problem) >= POLICY.explained


def with_steps(node: Node, found: Sequence[AcceptedStep], seed: int, *, wide: bool = True) -> Node:
    """Return the node after further steps, each with the noise floor of its own model.

    `wide`: the floor is at least the divergence of trajectories.
    """
    data, steps = node.data, list(node.steps)
    for step in found:
        data, runs = _refloor(step.fit, data, seed, wide=wide)
        steps.append(replace(step, data=data, runs=runs))
    current = rescored(steps[-1].fit, data)
    done = is_consistent(data, current.mean_squares)
    return replace(node, current=current, data=data, steps=tuple(steps), done=done)


def with_last_step(node: Node, last: AcceptedStep, seed: int) -> Node:
    """Return the node with another last step, and the noise floor of that step."""
    return with_steps(replace(node, steps=node.steps[:-1]), (last,), seed)


def is_consistent(data: Data, mean_squares: np.ndarray, *, by_signal: bool = True) -> bool:
    """Whether the training error is no larger than noise makes it (with `by_signal`, for each signal)."""
    scale = Scale.of(data.recordings[: data.training])
    draws = np.stack([data.pool(squares) for squares in data.noise_squares])
    return consistent(data.pool(mean_squares), draws, scale, data.pool(data.immaterial), by_signal=by_signal)


def _refloor(found: Fit, data: Data, seed: int, *, wide: bool = True) -> tuple[Data, Simulated | None]:
    """Return data with the noise floor of the fitted model (`wide`: at least its divergence), and its runs.

    Where its loop is unstable under noise, the floor of the model before is kept, and there are no runs.
    """
    try:
        fresh, simulated = data.of_model(found.hypothesis.model, seed)
    except SimulationError:
        return data.weighed_for(found.mean_squares), None
    if wide and found.hypothesis.diverges:
        fresh = replace(fresh, floor=np.maximum(fresh.floor, divergence(found, data)))
    return fresh.weighed_for(found.mean_squares), simulated
