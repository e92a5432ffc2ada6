"""All moves in the order in which they are tried: cheap and usually successful ones first."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ..acceptance import near_noise_floor
from ..loss import explained
from ..node import Growth, Node, explains_data
from ..node_acceptance import EXPLAINED, may_be_named, standing
from ..policy import POLICY
from ..problem import Problem
from ..screening.compliance import other_causes
from . import restarts
from .grid_refinement import with_refined_gap
from .joint_solution import of_all_axes
from .merge import merged
from .replace import replaced
from .simplify import simplified, without_needless


@dataclass(frozen=True)
class Move:
    """A way to reach further nodes from a node.

    Attributes:
        name: what it does, in words.
        propose: other nodes, the most promising first; worked out only as far as they are asked for.
        wanted: whether it is worth its work for a node, beside the best node so far. It is asked again before
            each further proposal.
        cheap: whether it is worth its work even where the budget is spent.
    """

    name: str
    propose: Callable[[Node, Problem], Iterator[Node]]
    wanted: Callable[[Node, Node, Problem], bool]
    cheap: bool = False


ONE_BY_ONE = "add one effect at a time"  #: what other starts are held against


def _grown(node: Node, problem: Problem) -> Iterator[Node]:
    yield node.begun(growth=Growth())


# When a move is wanted: of `node`, with the best node so far


def _first(node: Node, best: Node, problem: Problem) -> bool:
    """Return True, unless effects shared by all axes already explain the recordings to the noise."""
    return not node.move and (not best.steps or best.jointly or _may_be_wrong(best, problem))


def _jointly_first(node: Node, best: Node, problem: Problem) -> bool:
    """Return whether no loop is known, there are many axes, or no single effect explains the recordings."""
    first = not problem.data.replay.simulates or problem.is_expensive
    return not node.move and problem.limit > 1 and (first or not problem.one_effect_may_suffice)


def _jointly_last(node: Node, best: Node, problem: Problem) -> bool:
    """Return whether several effects are missing, or the explanation found may not be named."""
    if node.move or problem.limit == 1 or best.jointly:
        return False
    if len(best.steps) > 1 or standing(best, problem) < EXPLAINED:
        return True
    return not best.done and not may_be_named(best, problem)


def _unexplained(node: Node, best: Node, problem: Problem) -> bool:
    """Return whether forward selection left the recordings unexplained."""
    return _may_be_replaced(node, best, problem) and standing(best, problem) < EXPLAINED


def _above_noise(node: Node, best: Node, problem: Problem) -> bool:
    """Return whether forward selection left more than noise."""
    return _may_be_replaced(node, best, problem) and _may_be_wrong(best, problem)


def _on_axes_not_at_noise(node: Node, best: Node, problem: Problem) -> bool:
    """Return whether forward selection left more than noise on several axes.

    One effect of a single axis that comes near the noise is simpler; one of the whole machine may stand for
    one on each of its axes.
    """
    if not _may_be_replaced(node, best, problem) or best.done:
        return False
    on_one_axis = len(best.steps) == 1 and best.steps[0].added.axis is not None
    return not on_one_axis or _may_be_wrong(best, problem)


def _unexplained_or_ambiguous(node: Node, best: Node, problem: Problem) -> bool:
    """Return whether nothing explains the recordings, or an early effect may be wrong and later ones may
    correct it.
    """
    if not _may_be_replaced(node, best, problem):
        return False
    return standing(best, problem) < EXPLAINED or (node is best and _is_ambiguous(node, problem))


def _best(node: Node, best: Node, problem: Problem) -> bool:
    """Return whether this node comes from forward selection and is the best."""
    return node is best and bool(node.steps) and not node.jointly


def _best_with_gap(node: Node, best: Node, problem: Problem) -> bool:
    return node.diverges and (node is best or node.move == ONE_BY_ONE)


def _best_above_noise(node: Node, best: Node, problem: Problem) -> bool:
    """Return whether this best node explains the data but is not yet at the noise floor."""
    if not _best(node, best, problem) or node.done or node.diverges:
        return False
    return explained(problem.data, problem.start, node.current, node.data) >= POLICY.explained


def _best_explains(node: Node, best: Node, problem: Problem) -> bool:
    return _best(node, best, problem) and not node.diverges and explains_data(node, problem)


def _may_be_replaced(node: Node, best: Node, problem: Problem) -> bool:
    """Return whether forward selection ended, and the best node may be any approximation.

    Effects on several axes, each certain by itself, are none: what bold starts explain besides is no better.
    """
    return node.move == ONE_BY_ONE and problem.limit > 1 and not best.has_several_certain


def _may_be_wrong(best: Node, problem: Problem) -> bool:
    if standing(best, problem) < EXPLAINED:
        return True
    return not best.done and not near_noise_floor(best.current, best.data)


def _is_ambiguous(node: Node, problem: Problem) -> bool:
    model, more = problem.start.hypothesis.model, node.size > POLICY.plain_parameters
    return more and any(
        other_causes(model, step.added, step.indistinguishable_at(node.current)) for step in node.steps[:-1]
    )


MOVES = (
    Move("all axes together", of_all_axes, _jointly_first, cheap=True),
    Move(ONE_BY_ONE, _grown, _first),
    Move("other sizes of a gap", with_refined_gap, _best_with_gap),
    Move("a gap or soft joint that explains the residual torque", restarts.clear_compliance, _above_noise),
    Move("one cause on every axis", restarts.on_all_axes, _on_axes_not_at_noise),
    Move("two causes at once", restarts.two_at_once, _unexplained_or_ambiguous),
    Move("the torque along the motion", restarts.along_the_motion, _unexplained),
    Move("another cause in place of one", replaced, _best_above_noise),
    Move("one cause in place of two", merged, _best_explains),
    Move("without effects that are no longer needed", without_needless, _best, cheap=True),
    Move("a special case in place of a refinement", simplified, _best, cheap=True),
    Move("all axes together, tried again", of_all_axes, _jointly_last, cheap=True),
)  # fmt: skip
