"""The rule by which a node of the search replaces the best one so far."""

from __future__ import annotations

from .acceptance import at_noise_floor, halves_excess, improves_residual, near_noise_floor
from .adequacy.adequacy import adequacies
from .adequacy.imitations import imitate_another_law
from .adequacy.link_errors import several_wrong
from .loss import explained, rescored
from .node import Node, explained_share, explains_data
from .policy import POLICY
from .problem import Problem, evaluated

UNEXPLAINED, CERTAIN, EXPLAINED = range(3)  #: standings of nodes, see `standing`


def standing(node: Node, problem: Problem) -> int:
    """Return the standing of a node: it explains the data; its effects are certain though more is missing; or
    neither.

    Of bold starts there are many, and one of them may explain the data by chance: it has to explain more.
    """
    if explains_data(node, problem) and (not node.bold or _explains_nearly_all(node, problem)):
        return EXPLAINED
    return CERTAIN if node.jointly else UNEXPLAINED


def accepts(child: Node, best: Node, problem: Problem) -> tuple[bool, str]:
    """Return whether a node replaces the best one so far, and the reason.

    It says more than that; or as much, with at most half of its excess; or with no more than the noise, or
    as well by the rule of the move that made it from another, and no more parameters. Runs that diverge leave
    a rest whatever the model: what adds effects to them is no better. What explains the recordings and may
    not be named says less than effects that are certain.
    """
    new, old = standing(child, problem), standing(best, problem)
    if child.jointly or best.jointly:
        new, old = _named(child, new, problem), _named(best, old, problem)
    if new < old or (new == old == UNEXPLAINED and child.bold):
        return False, _too_little(child, problem)
    if new > old:
        return True, "it explains the recordings" if new == EXPLAINED else "its effects are certain"
    if not best.steps:
        return bool(child.steps), "the best so far" if child.steps else "no effect helps by itself"
    if best.diverges and child.keys > best.keys:
        return False, (
            "it adds effects to the best so far, whose runs diverge, so its remaining error says nothing"
        )
    found = rescored(child.current, best.data)
    if child.keys > best.keys and not improves_residual(found, best.current, problem.start, best.data):
        return False, "what it adds to the best so far lowers the error too little"
    if not best.done and halves_excess(found, best.current, best.data):
        return True, "it leaves less than half of the excess error of the best so far"
    # of two with as many parameters the one that was fitted in its loop
    size, others = (child.size, child.jointly), (best.size, best.jointly)
    if child.as_good and size <= others:
        return True, "it is as good, with no more parameters"
    if size < others and (child.done or at_noise_floor(child.current, child.data)):
        return True, "noise explains the rest, with fewer parameters"
    return False, "it leaves more than half of the excess error of the best so far, and is no simpler"


def may_be_named(node: Node, problem: Problem) -> bool:
    """Return whether the effects of a node may be named if they explain the recordings.

    Where more than noise is left, each has to be the law of its quantities, and not merely close to it.
    """
    return node.may_be_named and (node.done or are_the_laws(node, problem))


def are_the_laws(node: Node, problem: Problem) -> bool:
    """Return whether the effects of a node explain what free functions of their quantities explain, and
    follow no other law's curve.

    Only torques along the measured motion can be asked. A joint solution was asked when it was found.
    """
    along, added = problem.inverse_dynamics, node.current.hypothesis.added
    if node.jointly or along is None:
        return True
    data, _, regression = along
    if several_wrong(added, regression, regression.without_shape(node.keys), data)[0]:
        return False
    if not node.keys <= {e.key for e in regression.entries}:
        return True
    if imitate_another_law(added, regression):
        return False
    model = node.current.hypothesis
    found = evaluated(model, data.run([model.model])[0], data)
    return all(a.is_adequate for a in adequacies(found, regression, data).values())


def _named(node: Node, stands: int, problem: Problem) -> int:
    """Return a standing when certain effects are available: an explanation that may not be named ranks below
    them.
    """
    if stands < EXPLAINED or may_be_named(node, problem):
        return stands
    return CERTAIN if node.adequacy else UNEXPLAINED


def _explains_nearly_all(node: Node, problem: Problem) -> bool:
    """Return whether hardly more than the noise is left, or nearly all is explained."""
    if node.done or near_noise_floor(node.current, node.data):
        return True
    share = explained(problem.data, problem.start, node.current, node.data)
    return share > POLICY.explained_elsewhere


def _too_little(node: Node, problem: Problem) -> str:
    share = explained_share(node, problem)
    asked = POLICY.explained_elsewhere if node.bold else POLICY.explained
    # cut, not rounded: what is not enough must not read as if it were
    gone = f"it explains {int(100 * share)} % of the squared error above the noise"
    short = f"less than the {100 * asked:.0f} % required" if share < asked else "and is not certain"
    return f"{gone}, {short}"
