"""Other starts than one effect after the other.

All but one are bold: no data have confirmed by itself what they begin with, and only the end of the search
that follows can. They yield nodes that are grown one effect at a time before they are judged.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..acceptance import holdout_insensitive, near_noise_floor
from ..loss import rescored
from ..node import (
    Growth,
    Node,
    explains_data,
    linearisation_at,
    node_after,
    screened_at,
    with_steps,
)
from ..policy import POLICY
from ..problem import Problem
from ..screening.screen import screen
from ..search_result import AcceptedStep
from .add import next_step
from .choice import better_refinement
from .compliance_from_torque import compliance_from_torque
from .inverse_dynamics import inverse_dynamics_start
from .pairs import best_pair
from .shared_effects import shared_effects

_THROUGH = Growth(through_divergence=True)


def clear_compliance(node: Node, problem: Problem) -> Iterator[Node]:
    """A compliance that explains nearly all of the inverse-dynamics residual, from each place on the way.

    Later places have more true causes (friction that hides backlash), and more that only approximate others.
    Inertia alone can explain most of what backlash causes.
    """
    for count in range(len(node.steps) + 1):
        yield from _with_compliance(
            node_after(node.steps[:count], problem), problem, 0.0, POLICY.torque_first
        )


def likely_compliance(node: Node, problem: Problem) -> Iterator[Node]:
    """A compliance that explains most of the inverse-dynamics residual of the model as given."""
    at = node_after((), problem)
    yield from _with_compliance(at, problem, POLICY.torque_first, POLICY.torque_plain)


def _with_compliance(at: Node, problem: Problem, least: float, most: float) -> Iterator[Node]:
    """The node with a compliance, not confirmed in the loop.

    `least`, `most`: bounds of the share of the residual torque that it leaves.
    """
    linearisation = linearisation_at(at.current, at.data, problem)
    steps = compliance_from_torque(linearisation, at.data, at.current, problem.progress, least, most)
    if steps:
        yield _bold(at, steps, problem, _THROUGH, wide=False)


def on_training(node: Node, problem: Problem) -> Iterator[Node]:
    """A first effect chosen by cross-validation, where held-out motion is insensitive."""
    data, start = problem.data, problem.start
    if not holdout_insensitive(start, data):
        return
    problem.progress("beginning with what the training recordings show")
    by_folds = data.cross_validated()
    screened, _ = screen(problem.linearisation, by_folds, start.simulated, ())
    at = rescored(start, by_folds)
    step = next_step(problem.linearisation, screened, at, by_folds, problem.progress)
    yield from _started((step,) if step else (), problem)


def on_all_axes(node: Node, problem: Problem) -> Iterator[Node]:
    """One effect, or a few that belong together, on all axes that need it, and nothing else; asked once.

    They are one of a dozen sets, not of thousands: what explains the data is enough.
    """
    if not problem.is_new("all axes"):
        return
    steps = shared_effects(problem)
    if steps:
        yield with_steps(Node(problem.start, problem.data), steps, problem.seed)


def two_at_once(node: Node, problem: Problem) -> Iterator[Node]:
    """The best pair of effects: the best first step may be neither of them."""
    yield from _started(best_pair(problem), problem)


def along_the_motion(node: Node, problem: Problem) -> Iterator[Node]:
    """Effects found along the measured motion, where no loop holds an axis."""
    yield from _started(inverse_dynamics_start(problem), problem)


def _started(steps: Sequence[AcceptedStep], problem: Problem) -> Iterator[Node]:
    if steps:
        yield _bold(Node(problem.start, problem.data), steps, problem, Growth())


def a_refinement(node: Node, problem: Problem) -> Iterator[Node]:
    """The place where a basic effect was taken first that left much more than a refinement did.

    An inertia and a weight explain most of what a wrong torque constant and an encoder offset cause.
    Refinements that came later anyway are not begun with where the data are explained.
    """
    known = node.keys if explains_data(node, problem) else frozenset()
    for k, step in enumerate(node.steps):
        before = node_after(node.steps[:k], problem)
        better = better_refinement(step.added, step.ranking)
        if better is None or better in known or not problem.is_new("refinement", before.keys, step.added):
            continue
        problem.progress(f"beginning again from where {step.added} was taken")
        yield before.begun(growth=replace(_THROUGH, basics_first=False), bold=True)
        return


def what_training_shows(node: Node, problem: Problem) -> Iterator[Node]:
    """The effect that explains most of the remaining training error, whatever the folds say.

    Where several causes are missing, one of them alone may raise the error on held-out recordings.
    """
    current, by_folds = node.current, node.data.cross_validated()
    if near_noise_floor(current, node.data):
        return
    problem.progress("trying what explains most of the training recordings")
    linearisation, screened = screened_at(current, by_folds, problem)
    before, later = rescored(current, by_folds), bool(node.steps)
    step = next_step(
        linearisation, screened, before, by_folds, problem.progress, later=later, provisional=True
    )
    if step is not None:
        yield _bold(node, (step,), problem, _THROUGH, wide=False)


def _bold(
    at: Node, steps: Sequence[AcceptedStep], problem: Problem, growth: Growth, *, wide: bool = True
) -> Node:
    return with_steps(at.begun(growth=growth, bold=True), steps, problem.seed, wide=wide)
