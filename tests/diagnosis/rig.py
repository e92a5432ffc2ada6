"""Short experiments on the virtual leg, enough to tell effects apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from workbench.core import EffectKey, Recording
from workbench.diagnosis import search
from workbench.diagnosis.data import gather
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Hypothesis, applied_effect
from workbench.diagnosis.node import Node, with_steps
from workbench.diagnosis.problem import Problem, starting_fit
from workbench.diagnosis.search_result import AcceptedStep, SearchResult
from workbench.models import AppliedEffect, Model
from workbench.rigs import HiddenEffect, VirtualLeg, chirp, multisine, slow_sweep, validation


def recordings(*hidden: HiddenEffect, seed: int = 5) -> tuple[list[Recording], list[Recording]]:
    """Training and held-out recordings of a leg with something hidden in it, 17 s in all."""
    experiments = [
        multisine("sum", period=2.0, duration=4.0),
        chirp("knee", duration=4.0),
        slow_sweep(duration=6.0),
        validation(seed, duration=3.0),
    ]
    made = VirtualLeg(hidden, seed=seed).run(experiments)
    return made[:-1], made[-1:]


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


def searched_from(
    monkeypatch: pytest.MonkeyPatch,
    model: Model,
    hidden: Sequence[HiddenEffect],
    *steps: AppliedEffect,
    loss_ratios: tuple[tuple[EffectKey, float], ...] = (),
    iterations: int = 8,
) -> SearchResult:
    """What a search makes of these steps, handed to it as those it took; `loss_ratios` the first of them."""

    def forward_selection(node: Node, problem: Problem, **_: Any) -> Node:
        accepted = []
        for k, step in enumerate(steps):
            (found,) = fit([Hypothesis(model, steps[: k + 1])], node.data, iterations)
            assert found is not None
            close = () if k else loss_ratios
            accepted.append(
                AcceptedStep(step.key, found, node.data, 1.0, (), (), (), (), close, (1, 1), True)
            )
        return with_steps(node, tuple(accepted), problem.seed)

    monkeypatch.setattr(search, "forward_selection", forward_selection)
    return search.search(model, *recordings(*hidden))
