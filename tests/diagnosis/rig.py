"""Short experiments on the virtual leg, enough to tell effects apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from workbench.core import EffectKey, Recording
from workbench.diagnosis.data import gather
from workbench.diagnosis.explore import explore
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Hypothesis, applied_effect
from workbench.diagnosis.moves.order import ONE_BY_ONE
from workbench.diagnosis.node import Node, with_steps
from workbench.diagnosis.problem import Problem, starting_fit
from workbench.diagnosis.search_result import AcceptedStep
from workbench.models import AppliedEffect, Model
from workbench.rigs import HiddenEffect, VirtualLeg, chirp, multisine, slow_sweep, validation

#: What was recorded already, by what was hidden: what is known of a recording is worked out once for each.
_RECORDED: dict[str, list[Recording]] = {}


def recordings(*hidden: HiddenEffect, seed: int = 5) -> tuple[list[Recording], list[Recording]]:
    """Training and held-out recordings of a leg with something hidden in it, 17 s in all."""
    key = repr((hidden, seed))
    if key not in _RECORDED:
        experiments = [
            multisine("sum", period=2.0, duration=4.0),
            chirp("knee", duration=4.0),
            slow_sweep(duration=6.0),
            validation(seed, duration=3.0),
        ]
        _RECORDED[key] = VirtualLeg(hidden, seed=seed).run(experiments)
    *training, held_out = _RECORDED[key]
    return training, [held_out]


#: Neither is plain in the closed loop while the other is missing.
SPRING_AND_DELAY = (
    HiddenEffect("joint_compliance", "knee", parameters={"stiffness": 91.0, "damping": 0.12}),
    HiddenEffect("sensor_delay", parameters={"time": 0.0013}),
)


def asked(model: Model, training: Sequence[Recording], held_out: Sequence[Recording] = ()) -> Problem:
    """What a search is asked of these recordings."""
    data, runs = gather(model, training, held_out, seed=0)
    return Problem(starting_fit(model, data, runs.clean), data, 6, 0, lambda text: None)


def applied(model: Model, key: EffectKey, **values: float) -> AppliedEffect:
    """An effect of these values, in the units that its axis has."""
    return applied_effect(model, AppliedEffect(key), values)


def node_with(
    problem: Problem,
    *steps: AppliedEffect,
    loss_ratios: tuple[tuple[EffectKey, float], ...] = (),
    ranking: tuple[tuple[EffectKey, float], ...] = (),
    iterations: int = 8,
    **begun: Any,
) -> Node:
    """The node after these steps, as if found one by one; `loss_ratios` and `ranking` are of the first."""
    model, accepted, before = problem.start.hypothesis.base, [], problem.start
    for k, step in enumerate(steps):
        (found,) = fit([Hypothesis(model, steps[: k + 1])], problem.data, iterations)
        assert found is not None
        told = {} if k else {"loss_ratios": loss_ratios, "ranking": ranking}
        accepted.append(AcceptedStep.between(before, found, step.key, problem.data, **told))
        before = found
    root = Node(problem.start, problem.data)
    return with_steps(root.begun(**begun), accepted, problem.seed)


def explored_from(problem: Problem, *steps: AppliedEffect, **told: Any) -> Node:
    """Where a search ends that one effect after the other has led to these steps."""
    return explore(node_with(problem, *steps, move=ONE_BY_ONE, **told), problem)[0]
