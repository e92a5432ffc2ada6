"""The rule by which a node of the search takes the place of the best one so far."""

from __future__ import annotations

from .acceptance import at_noise_floor, halves_excess, near_noise_floor
from .loss import explained, rescored
from .node import Node, explains_data
from .policy import POLICY
from .problem import Problem

UNEXPLAINED, CERTAIN, EXPLAINED = range(3)  #: standings of nodes, see `standing`


def standing(node: Node, problem: Problem) -> int:
    """How much a node says: it explains the data; its effects are certain though more is missing; neither.

    Of bold starts there are many, and one of them may explain the data by chance: it has to explain more.
    """
    if explains_data(node, problem) and (not node.bold or _explains_nearly_all(node, problem)):
        return EXPLAINED
    return CERTAIN if node.jointly else UNEXPLAINED


def accepts(child: Node, best: Node, problem: Problem) -> bool:
    """Whether a node takes the place of the best one so far.

    It says more than that; or as much, with at most half of its excess; or with no more than the
    noise, or as well by the rule of the move that made it from another, and fewer parameters.
    """
    new, old = standing(child, problem), standing(best, problem)
    if new != old:
        return new > old
    if not best.steps:
        return bool(child.steps) and not child.bold
    if not best.done and halves_excess(rescored(child.current, best.data), best.current, best.data):
        return True
    # of two with as many parameters the one that was fitted in its loop
    sizes = (child.size, child.jointly), (best.size, best.jointly)
    if child.as_good and sizes[0] <= sizes[1]:
        return True
    return sizes[0] < sizes[1] and (child.done or at_noise_floor(child.current, child.data))


def _explains_nearly_all(node: Node, problem: Problem) -> bool:
    """Whether hardly more than the noise is left, or nearly all is explained."""
    if node.done or near_noise_floor(node.current, node.data):
        return True
    share = explained(problem.data, problem.start, node.current, node.data)
    return share > POLICY.explained_elsewhere
