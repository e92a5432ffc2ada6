"""A move: from one node of the search to others, and when it is worth its work."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ..node import Node
from ..problem import Problem


@dataclass(frozen=True)
class Move:
    """A way from a node to others.

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
