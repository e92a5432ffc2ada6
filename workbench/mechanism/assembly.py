"""A mechanism put together for the first time: loops closed near the start posture, freedoms counted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import InputError, Mechanism
from workbench.core.closure import DEAD, Closure

from .closing import close, closed_near_start
from .tree import Tree

_SEED = 7  # what is random here has to come out the same every time


def check_names(mechanism: Mechanism) -> None:
    """Check that there is one serial joint per drive, and that each is named once.

    Raises:
        InputError: there is not.
    """
    n = len(mechanism.drives)
    for key, names in (("drives", mechanism.drives), ("joints", mechanism.joints)):
        if not n or len(names) != n or len(set(names)) != n:
            raise InputError(
                f"{n} drives, and {key} are {', '.join(names) or 'none'}", file=mechanism.file,
                column=f"closed_chain.{key}", remedy="name one serial joint per drive, each once",
            )  # fmt: skip


def assemble(tree: Tree, drives: Sequence[int]) -> np.ndarray:
    """Return a closed posture (N,) that the drives determine, as near the start posture as it can be.

    Args:
        tree: the cut mechanism.
        drives: positions in theta of the driven joints, length n.

    Raises:
        InputError: the loops do not close near the start posture, or leave another number of freedoms than
            there are drives; says which joints are free then.
    """
    theta = closed_near_start(tree, drives)
    _count_freedoms(tree, drives, theta)
    closure = Closure(tree, drives, theta)
    if closure.at(theta[closure.independent]).slope is not None:
        return theta
    return _leave_dead_point(tree, closure, theta)


def _count_freedoms(tree: Tree, drives: Sequence[int], theta: np.ndarray) -> None:
    """As many freedoms as drives, at a posture that is not special.

    Raises:
        InputError: there are more, or fewer.
    """
    passive = [i for i in range(len(theta)) if i not in drives]
    jacobian = generic_jacobian(tree, theta, passive)
    freedoms = len(theta) - rank(jacobian)
    loose = _loose(jacobian[:, passive])
    if freedoms < len(drives):
        raise InputError(
            f"the loops leave {freedoms} degrees of freedom for {len(drives)} drives",
            file=tree.mechanism.file, column="closed_chain.loops", remedy="leave out a loop or a drive",
        )  # fmt: skip
    if loose.any():
        names = ", ".join(tree.names[i] for i, free in zip(passive, loose, strict=True) if free)
        raise InputError(
            f"the loops leave {freedoms} degrees of freedom for {len(drives)} drives: with the drives held, "
            f"{names} can still move", file=tree.mechanism.file, column="closed_chain.loops",
            remedy="name the loop that is missing, hold the joint (import has --hold) or name it as a drive",
        )  # fmt: skip


def generic_jacobian(tree: Tree, theta: np.ndarray, passive: Sequence[int]) -> np.ndarray:
    """Return the gaps' Jacobian of highest rank in closed postures near `theta`, maybe a dead point.

    Of the whole, then of the passive coordinates alone: a crank in line with its rod is a dead point of a
    drive at the far end, where the loops are as good as anywhere.
    """

    def ranks(jacobian: np.ndarray) -> tuple[int, int]:
        return rank(jacobian), rank(jacobian[:, passive])

    generator = np.random.default_rng(_SEED)
    tree.move(theta)
    best = tree.gap_jacobian()
    if best.size == 0:
        return best
    _, values, v = np.linalg.svd(best)
    tangents = v[int(np.sum(values > DEAD * values[0])) :]
    for _ in range(4):
        near = close(tree, theta + 0.2 * generator.standard_normal(len(tangents)) @ tangents)
        if near is not None:
            tree.move(near)
            jacobian = tree.gap_jacobian()
            best = max(best, jacobian, key=ranks)
    return best


def rank(matrix: np.ndarray) -> int:
    """Rank to what rounding leaves of it, 0 of an empty matrix."""
    if matrix.size == 0:
        return 0
    values = np.linalg.svd(matrix, compute_uv=False)
    return int(np.sum(values > 1e-7 * values[0]))


def _loose(gap_d: np.ndarray) -> np.ndarray:
    """Which dependent coordinates move in some way that keeps the loops closed."""
    if gap_d.shape[1] == 0:
        return np.zeros(0, bool)
    free = np.linalg.svd(gap_d)[2][rank(gap_d) :] if gap_d.size else np.eye(gap_d.shape[1])
    return np.abs(free).max(axis=0, initial=0.0) > 1e-6


def _leave_dead_point(tree: Tree, closure: Closure, theta: np.ndarray) -> np.ndarray:
    """A closed posture beside a start posture that is itself a dead point.

    A straight parallelogram is one: from there both the parallelogram and its folded twin go on. The one
    whose joints go on most evenly is taken, which is the parallelogram; to get another, give `start`.
    """
    generator = np.random.default_rng(_SEED)
    alternating = 1.0 - 2.0 * (np.arange(len(closure.independent)) % 2)
    for direction in (-alternating, alternating, np.abs(alternating), -np.abs(alternating)):
        way = np.zeros(len(theta))
        way[closure.independent] = 0.25 * direction
        found = []
        for _ in range(20):
            way[closure.dependent] = generator.uniform(-0.6, 0.6, len(closure.dependent))
            found += _branch(closure, theta, theta + way)
        if not found:
            continue
        # loops that are independent of each other fold over one by one, so each coordinate votes alone
        most_even = np.argmin([uneven for _, uneven in found], axis=0)
        voted = np.array([posture for posture, _ in found])[most_even, np.arange(len(theta))]
        best, uneven = min(found + _branch(closure, theta, voted), key=lambda entry: entry[1].max())
        if uneven.max() < 0.1:
            return best
    raise InputError(
        f"the start posture is a dead point: {closure.say(theta[closure.independent])}",
        file=tree.mechanism.file, column="closed_chain.start", remedy="give angles away from it",
    )  # fmt: skip


def _branch(closure: Closure, theta: np.ndarray, guess: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """The closed posture at `guess`, and how uneven the way from `theta` through it is; none if it fails."""
    first = closure.solve(guess)
    second = None if first is None else closure.solve(2.0 * first - theta)
    return [] if first is None or second is None else [(first, np.abs(second - 2.0 * first + theta))]
