"""The search among nodes: moves propose nodes, cheapest first, until none replaces the best one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from heapq import heappop, heappush
from itertools import count, takewhile

from workbench.core import Tried

from .moves.add import grown
from .moves.order import MOVES, Move
from .moves.replace import with_rivals_beside_all
from .node import Node, explained_share, node_after
from .node_acceptance import accepts
from .problem import Problem
from .significance import is_significant

_RANKED = 8  # rivals that are told of each effect that was added


def explore(root: Node, problem: Problem) -> tuple[Node, tuple[Tried, ...]]:
    """Return the best node that moves reach from a root, without insignificant last effects, and the trace.

    The rivals of its effects are those beside all of them.

    A proposed node is grown one effect at a time, as far as it asks for. Where it leads takes the place of
    the best node so far by one rule (`accepts`); all moves are then asked about the new one too.
    """
    agenda, best, trace = _Agenda(problem), root, []
    agenda.add(root)
    while not best.enough:
        proposal = agenda.next(best)
        if proposal is None:
            break
        parent, child = proposal
        end = grown(child, problem)
        agenda.add(end)
        # what is added to certain effects has to be better than these
        for node in dict.fromkeys((child, end) if child.jointly else (end, child)):
            taken, why = accepts(node, best, problem)
            if node is end or taken:
                trace.append(_tried(parent, node, taken, why, problem))
            if taken:
                best = node
                if not (best.done or best.diverges):
                    problem.suspect(best.current, best.data)
                if node is not end:
                    agenda.add(node)
                if not child.jointly:
                    break
    return with_rivals_beside_all(without_insignificant_end(best, problem), problem), tuple(trace)


def _tried(parent: Node, node: Node, taken: bool, why: str, problem: Problem) -> Tried:
    """Return the trace of a proposal, from the steps that it shares with its parent on."""
    pairs = zip(parent.steps, node.steps, strict=False)
    shared = sum(1 for _ in takewhile(lambda pair: pair[0].added == pair[1].added, pairs))
    before = node_after(node.steps[:shared], problem)
    fits = [(before.current, before.data), *((s.fit, s.data) for s in node.steps[shared:])]
    return Tried(
        node.move,
        tuple(a.key for a in before.current.hypothesis.added),
        tuple((s.added, s.ranking[:_RANKED]) for s in node.steps[shared:]),
        tuple(a.key for a in node.current.hypothesis.added),
        tuple(data.score(fit.mean_squares) / data.score(data.floor) for fit, data in fits),
        explained_share(node, problem) if node.steps else 0.0,
        node.size,
        taken,
        why,
    )


class _Agenda:
    """Moves from nodes, in the order of `MOVES`; a move is computed only when it is needed."""

    def __init__(self, problem: Problem) -> None:
        self._problem, self._number = problem, count()
        self._queue: list[tuple[int, int, Node, Iterator[Node]]] = []

    def add(self, node: Node) -> None:
        """Add all moves from a node."""
        for rank, move in enumerate(MOVES):
            heappush(self._queue, (rank, next(self._number), node, self._proposed(move, node)))

    def next(self, best: Node) -> tuple[Node, Node] | None:
        """Return the next proposal that may compete with the best node, after the node it starts from."""
        while self._queue:
            rank, _, node, proposals = self._queue[0]
            move = MOVES[rank]
            affordable = move.cheap or not best.data.budget.spent
            wanted = affordable and move.wanted(node, best, self._problem)
            child = next(proposals, None) if wanted else None
            if child is not None:
                return node, replace(child, move=move.name)
            heappop(self._queue)
        return None

    def _proposed(self, move: Move, node: Node) -> Iterator[Node]:
        """Return what a move proposes, once for each set of effects."""
        if self._problem.is_new(move.name, node.keys):
            yield from move.propose(node, self._problem)


def without_insignificant_end(node: Node, problem: Problem) -> Node:
    """Return the node without insignificant last effects; what they explained stays unexplained.

    What is certain of the others stays so.
    """
    steps = node.steps
    while steps:
        last = next(a for a in steps[-1].fit.hypothesis.added if a.key == steps[-1].added)
        if last in steps[-1].fit.hypothesis.parameter_free or is_significant(last):
            break
        steps = steps[:-1]
    if len(steps) == len(node.steps):
        return node
    after = node_after(steps, problem)
    sure = {key: found for key, found in node.adequacy.items() if key in after.keys}
    return replace(node, current=after.current, data=after.data, steps=steps, done=after.done, adequacy=sure)
