"""The move that puts two effects with fewer parameters in place of all that were found."""

from __future__ import annotations

from ..acceptance import at_noise_floor
from ..node import Node, with_steps
from ..problem import Problem
from ..screening.compliance import other_causes
from ..search_result import AcceptedStep
from .pairs import best_pair


def with_fewer_parameters(node: Node, problem: Problem) -> Node:
    """The node of two effects with fewer parameters that explain as much as all that were found; else `node`.

    It is tried where an earlier effect was indistinguishable from others: later effects may only correct a
    wrong choice.
    """
    size = node.current.hypothesis.size
    few = len(node.steps) < 2 or size < 3
    if (
        few
        or problem.data.budget.spent
        or not any(_has_alternatives(s, node, problem) for s in node.steps[:-1])
    ):
        return node
    steps = best_pair(problem.linearisation, problem.data, problem.start, problem.progress)
    if steps is None:
        return node
    other = with_steps(Node(problem.start, problem.data), steps, problem.seed)
    return (
        other if other.current.hypothesis.size < size and at_noise_floor(other.current, other.data) else node
    )


def _has_alternatives(step: AcceptedStep, node: Node, problem: Problem) -> bool:
    """Whether another cause fits as well, other than the equivalent place at the joint."""
    model = problem.start.hypothesis.model
    return bool(other_causes(model, step.added, step.indistinguishable_at(node.current)))
