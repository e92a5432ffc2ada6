"""A start from inverse dynamics: effects of the residual torque along the measured motion."""

from __future__ import annotations

from dataclasses import replace

from workbench.core import Recording
from workbench.simulation import scored_torque

from ..fitting.fit import fit
from ..fitting.refinement import converged
from ..node import Growth, Node
from ..problem import Problem
from ..search_result import AcceptedStep
from .add import grown


def inverse_dynamics_start(problem: Problem) -> tuple[AcceptedStep, ...]:
    """Steps with effects that explain the torque along the measured motion, then fitted in the closed loop.

    A pendulum that swings freely on a cart swings on where its friction is missing: the simulated motion soon
    differs from the measured one, and its sensitivities say nothing. Along the measured motion the friction
    is identifiable.

    Returns:
        One step an effect, without its own data and runs. None where that replay was used already, a loop
        holds every axis to its reference, no torque was recorded, or nothing is missing.
    """
    recordings = problem.data.recordings
    blind = any(scored_torque(r) is None for r in recordings)
    if blind or not any(map(_swings, recordings)) or not problem.data.replay.simulates:
        return ()
    problem.progress("asking the torque along the measured motion")
    if problem.inverse_dynamics is None:
        return ()
    data, start, _ = problem.inverse_dynamics
    asked = Problem(start, data, problem.limit, problem.seed, problem.progress)
    return _in_the_loop(grown(Node(start, data, growth=Growth()), asked), problem)


def _swings(recording: Recording) -> bool:
    """Whether no loop holds some axis to its reference."""
    loop = recording.controller
    return loop.kind == "none" or not all(loop.kp)


def _in_the_loop(node: Node, problem: Problem) -> tuple[AcceptedStep, ...]:
    """Steps found along the motion, each fitted in the loops of the problem."""
    if not node.steps:
        return ()
    fits = fit([step.fit.hypothesis for step in node.steps], problem.data)
    if fits[-1] is None:
        return ()
    last = converged(fits[-1], problem.data)
    # an intermediate loop may not run although the final one does
    steps = [replace(s, fit=f or last, data=problem.data) for s, f in zip(node.steps, fits, strict=True)]
    return (*steps[:-1], replace(steps[-1], fit=last))
