"""Alternative starts of the search, beside forward selection.

All but one are bold: no data have confirmed by itself what they begin with, and only the end of the search
that follows can. They yield nodes that are grown one effect at a time before they are judged.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from workbench.core import Recording
from workbench.simulation import scored_torque

from ..fitting.fit import fit
from ..fitting.refinement import converged
from ..node import Growth, Node, node_after, with_steps
from ..policy import POLICY
from ..problem import Problem
from ..search_result import AcceptedStep
from .add import grown
from .compliance_from_torque import compliance_from_torque
from .pairs import best_pair
from .shared_effects import shared_effects

_PLAIN, _THROUGH = Growth(), Growth(through_divergence=True)


def clear_compliance(node: Node, problem: Problem) -> Iterator[Node]:
    """Return a compliance that explains nearly all of the inverse-dynamics residual, from each accepted step.

    Later places have more true causes (friction that hides backlash), and more that only approximate others.
    Inertia alone can explain most of what backlash causes.
    """
    for count in range(len(node.steps) + 1):
        at = node_after(node.steps[:count], problem)
        steps = compliance_from_torque(at, problem, POLICY.torque_first)
        yield from _begun(at, steps, problem, _THROUGH, wide=False)


def on_all_axes(node: Node, problem: Problem) -> Iterator[Node]:
    """Return one effect, or a few that belong together, on every axis that needs it; asked once.

    They are one of a dozen sets, not of thousands: what explains the data is enough. More may be missing
    beside them.
    """
    if not problem.is_new("all axes"):
        return
    steps = shared_effects(problem)
    if steps:
        yield with_steps(node_after((), problem).begun(growth=_PLAIN), steps, problem.seed)


def two_at_once(node: Node, problem: Problem) -> Iterator[Node]:
    """Return the best pair of effects: the best first step may be neither of them."""
    yield from _begun(node_after((), problem), best_pair(problem), problem)


def along_the_motion(node: Node, problem: Problem) -> Iterator[Node]:
    """Return effects that explain the torque along the measured motion, then fitted in the closed loop.

    A pendulum that swings freely on a cart swings on where its friction is missing: the simulated motion soon
    differs from the measured one, and its sensitivities say nothing. Along the measured motion the friction
    is identifiable. Not asked where that replay was used already, a loop holds every axis to its reference,
    or no torque was recorded.
    """
    recordings = problem.data.recordings
    blind = any(scored_torque(r) is None for r in recordings)
    if blind or all(map(_holds, recordings)) or not problem.data.replay.simulates:
        return
    problem.progress("reading effects from the torque along the measured motion")
    if problem.inverse_dynamics is None:
        return
    data, start, _ = problem.inverse_dynamics
    asked = Problem(start, data, problem.limit, problem.seed, problem.progress)
    found = grown(Node(start, data, growth=Growth()), asked).steps
    fits = fit([step.fit.hypothesis for step in found], problem.data)
    if not fits or fits[-1] is None:
        return
    last = converged(fits[-1], problem.data)
    # an intermediate loop may not run although the final one does
    ends = [*(f or last for f in fits[:-1]), last]
    steps = [replace(s, fit=f, data=problem.data) for s, f in zip(found, ends, strict=True)]
    yield from _begun(node_after((), problem), steps, problem)


def _holds(recording: Recording) -> bool:
    """Return whether a loop holds all axes to their reference."""
    loop = recording.controller
    return loop.kind != "none" and all(loop.kp)


def _begun(
    at: Node,
    steps: Sequence[AcceptedStep],
    problem: Problem,
    growth: Growth = _PLAIN,
    *,
    wide: bool = True,
) -> Iterator[Node]:
    """The node with provisional steps, which no data have confirmed, ready to grow; none without steps."""
    if steps:
        yield with_steps(at.begun(growth=growth, bold=True), steps, problem.seed, wide=wide)
