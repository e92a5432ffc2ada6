"""Nodes of the search, and forward selection from one node to the next."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from workbench.comparison import Scale, Simulated, normalised
from workbench.comparison.consistent import consistent
from workbench.core import EffectKey, SimulationError
from workbench.effects import effect_named, kinds

from .acceptance import holdout_insensitive, improves_residual, too_little_left, unchanged_on_holdout
from .data import Data
from .fitting.divergence import divergence
from .hypothesis import Fit
from .loss import explained, median_explained, rescored
from .moves.add import next_step
from .policy import POLICY
from .problem import Problem
from .screening.screen import Candidate, screen
from .screening.sensitivity import Linearisation
from .screening.stiction import candidates
from .search_result import AcceptedStep

Keys = frozenset[EffectKey]


@dataclass(frozen=True)
class Node:
    """A node of the search: fit, data with noise floor, accepted steps, whether noise explains the rest."""

    current: Fit
    data: Data
    steps: tuple[AcceptedStep, ...] = ()
    done: bool = False


def forward_selection(
    node: Node,
    problem: Problem,
    *,
    allow_divergence: bool = False,
    basics_first: bool = True,
    visited: Collection[Keys] = (),
) -> Node:
    """The node after forward selection from `node`: one effect a step while one is accepted.

    `allow_divergence`: go on where trajectories diverge; the divergence is then measured at the end.
    `basics_first`: inertia, damping and Coulomb friction before others that explain somewhat more.
    `visited`: sets of effects whose continuation is known; the selection ends there.
    """
    take = partial(next_step, progress=problem.progress, basics_first=basics_first)
    current, data, steps, done = node.current, node.data, list(node.steps), node.done
    start, progress = problem.start, problem.progress
    most = len(steps) + problem.limit
    while not done and len(steps) < most and not (steps and too_little_left(current, start, data)):
        if effect_keys(current) in visited or data.budget.spent:
            break
        progress(f"screening effects, step {len(steps) + 1}")
        linearisation, screened = (
            screened_at(current, data, problem) if steps else (problem.linearisation, problem.screened)
        )
        step = take(linearisation, screened, current, data, later=bool(steps))
        if step is None and holdout_insensitive(current, data):
            # held-out motion may never show what is missing (a torque limit, for one)
            progress("judging by the recordings that show most")
            by_folds = data.cross_validated()
            screened, _ = screen(linearisation, by_folds, current.simulated, current.hypothesis.free)
            step = take(linearisation, screened, rescored(current, by_folds), by_folds, later=bool(steps))
            if step is not None and not unchanged_on_holdout(step.fit, current, data):
                step = None
        if step is None:
            break
        costless = any(a.key == step.added for a in step.fit.hypothesis.parameter_free)
        if steps and not costless and not improves_residual(step.fit, current, start, step.data):
            break
        progress(f"found {step.added}; simulating the noise")
        fresh, runs = _refloor(step.fit, data, problem.seed, wide=not allow_divergence)
        steps.append(replace(step, data=fresh, runs=runs))
        current = rescored(step.fit, fresh)
        # the residual of diverging trajectories says nothing about a further effect
        data, done = fresh, is_consistent(fresh, current.mean_squares)
        if diverges(current) and not allow_divergence:
            break
    return Node(current, data, tuple(steps), done)


def effect_keys(found: Fit) -> Keys:
    """Its effects."""
    return frozenset(a.key for a in found.hypothesis.added)


def screened_at(current: Fit, data: Data, problem: Problem) -> tuple[Linearisation, Sequence[Candidate]]:
    """The linearisation about the current fit, and every effect screened there."""
    linearisation = linearisation_at(current, data, problem)
    return linearisation, candidates(linearisation, current, data, problem.seed)


def linearisation_at(current: Fit, data: Data, problem: Problem) -> Linearisation:
    """The linearisation about the current fit, from the cache where the same runs were linearised before."""
    if not current.hypothesis.added:
        return problem.linearisation
    for linearisation in problem.linearisations:
        if all(a is b for a, b in zip(linearisation.runs, current.simulated, strict=True)):
            return linearisation
    linearisation = Linearisation.of(current.hypothesis.model, data, current.simulated, len(data.recordings))
    problem.linearisations.appendleft(linearisation)
    return linearisation


def node_after(steps: tuple[AcceptedStep, ...], problem: Problem) -> Node:
    """The node after some first steps; the start where there are none."""
    if not steps:
        return Node(problem.start, problem.data)
    data = steps[-1].data
    return Node(rescored(steps[-1].fit, data), data, steps)


def explains_data(node: Node, problem: Problem) -> bool:
    """Whether the effects of a node explain the data."""
    if node.done or not node.steps:
        return node.done
    ends = problem.data, problem.start, node.current, node.data
    shares = [explained(*ends), median_explained(*ends) if diverges(node.current) else 0.0]
    return max(shares) >= POLICY.explained


def with_steps(node: Node, found: Sequence[AcceptedStep], seed: int, *, wide: bool = True) -> Node:
    """The node after further steps, each with the noise floor of its own model."""
    data, steps = node.data, list(node.steps)
    for step in found:
        data, runs = _refloor(step.fit, data, seed, wide=wide)
        steps.append(replace(step, data=data, runs=runs))
    current = rescored(steps[-1].fit, data)
    return Node(current, data, tuple(steps), is_consistent(data, current.mean_squares))


def with_last_step(node: Node, last: AcceptedStep, seed: int) -> Node:
    """The node with another last step, and the noise floor of that."""
    return with_steps(replace(node, steps=node.steps[:-1]), (last,), seed)


def is_consistent(data: Data, mean_squares: np.ndarray, *, by_signal: bool = True) -> bool:
    """Whether the training error is no larger than noise makes it (and, `by_signal`, that of each signal)."""
    scale = Scale.of(data.recordings[: data.training])
    draws = np.stack([data.pool(np.stack([np.mean(x**2, axis=0) for x in draw])) for draw in data.draws])
    pooled = data.pool(mean_squares)
    error, floors = normalised(pooled, scale), np.array([normalised(d, scale) for d in draws])
    allowed = data.pool(data.immaterial)
    return consistent(pooled, draws, error, floors, allowed, by_signal=by_signal)


def diverges(found: Fit) -> bool:
    """Whether trajectories of the fitted model diverge for small parameter changes."""
    return any(kinds.runs_part(effect_named(a.key.effect)) for a in found.hypothesis.free)


def _refloor(found: Fit, data: Data, seed: int, *, wide: bool = True) -> tuple[Data, Simulated | None]:
    """Data with the noise floor of the fitted model (`wide`: at least its divergence), and its runs.

    Where its loop is unstable under noise, the floor of the model before is kept, and there are no runs.
    """
    try:
        fresh, simulated = data.of_model(found.hypothesis.model, seed)
    except SimulationError:
        return data.reweighed(found.mean_squares).with_holdout_checked(found.mean_squares), None
    if wide and diverges(found):
        fresh = replace(fresh, floor=np.maximum(fresh.floor, divergence(found, data)))
    return fresh.reweighed(found.mean_squares).with_holdout_checked(found.mean_squares), simulated
