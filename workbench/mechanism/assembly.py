"""A mechanism put together for the first time: loops closed near the start posture, freedoms counted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import InputError

from .closure import CLOSED, DEAD, Closure
from .tree import Tree

_SEED = 7  # what is random here has to come out the same every time
_STRAYED = 0.2  # rad or m from what was stated of the start: still that posture
_HELD, _TRIES = 0.05, 40


def assemble(tree: Tree, drives: Sequence[int]) -> np.ndarray:
    """A closed posture (N,) that the drives determine, as near the mechanism's start posture as that allows.

    Args:
        tree: the cut mechanism.
        drives: positions in theta of the driven joints, length n.

    Raises:
        InputError: the loops do not close near the start posture, or leave another number of freedoms than
            there are drives; says which joints are free then.
    """
    theta = _near_start(tree, drives)
    if theta is None:
        raise InputError(
            f"the loops do not close near the start posture: {_gap_text(tree)}", file=tree.mechanism.file,
            column="closed_chain.start", remedy="give the joints' angles near a closed posture",
        )  # fmt: skip
    _count_freedoms(tree, drives, theta)
    closure = Closure(tree, drives, theta)
    if closure.at(theta[closure.independent]).slope is not None:
        return theta
    return _leave_dead_point(tree, closure, theta)


def _start(tree: Tree) -> np.ndarray:
    theta = np.zeros(len(tree.names))
    for name, value in tree.mechanism.start:
        if not np.isfinite(value):
            raise InputError(
                f"the start of '{name}' is {value}", file=tree.mechanism.file, column="closed_chain.start",
                remedy="give a number",
            )  # fmt: skip
        theta[tree.index(name, "start")] = value
    return theta


def _near_start(tree: Tree, drives: Sequence[int]) -> np.ndarray | None:
    """The closed posture nearest to what the mechanism states of its start, whatever else has to turn.

    Loops close in more than one way, and from the angles that nobody stated the nearest way may lead far from
    those that somebody did. Then passive coordinates are begun all round, and what was stated is held.
    """
    start, stated = _start(tree), [tree.index(name, "start") for name, _ in tree.mechanism.start]
    plain = _close(tree, start)
    if plain is not None and np.abs(plain - start)[stated].max(initial=0.0) < _STRAYED:
        return plain
    kept = {*stated, *drives, *(tree.index(name, "joints") for name in tree.mechanism.joints)}
    passive = [i for i in range(len(start)) if i not in kept]
    ease = np.ones(len(start))
    ease[stated] = _HELD
    generator, found = np.random.default_rng(_SEED), [] if plain is None else [plain]
    for _ in range(_TRIES):
        guess = start.copy()
        guess[passive] += generator.uniform(-np.pi, np.pi, len(passive))
        closed = _close(tree, guess, ease)
        found += [] if closed is None else [closed]
    cost = np.zeros(len(start))
    cost[list(kept)], cost[stated] = _HELD, 1.0
    if not found:
        return _close(tree, start)  # which says how far the loops gape
    return min(found, key=lambda theta: float(cost @ (theta - start) ** 2))


def _close(tree: Tree, theta: np.ndarray, ease: np.ndarray | float = 1.0) -> np.ndarray | None:
    """Gauss-Newton over all coordinates, which moves them as little as it can; None if it does not close.

    `ease` (N,): how readily each one gives way.
    """
    theta = theta.copy()
    for _ in range(60):
        tree.move(theta)
        gap = tree.gap()
        if np.abs(gap).max(initial=0.0) < 1e-15:
            return theta
        step = ease * np.linalg.lstsq(tree.gap_jacobian() * ease, gap, rcond=1e-12)[0]
        size = np.abs(step).max()
        theta -= step * min(1.0, 0.5 / max(size, 1e-300))  # half a radian at most
        if size < 1e-12:
            break
    tree.move(theta)
    return theta if np.abs(tree.gap()).max() < CLOSED else None


def _gap_text(tree: Tree) -> str:
    with np.errstate(over="ignore"):  # an infinite gap is one that stays open too
        gaps = tree.open_loops()
        if not gaps.size:
            return "a joint that follows another cannot be where it has to"
    return f"{gaps.max():.3g} m stay open at loop {int(gaps.argmax()) + 1}"


def _count_freedoms(tree: Tree, drives: Sequence[int], theta: np.ndarray) -> None:
    """As many freedoms as drives, at a posture that is not special.

    Raises:
        InputError: there are more, or fewer.
    """
    jacobian = _generic_jacobian(tree, theta)
    freedoms = len(theta) - _rank(jacobian)
    passive = [i for i in range(len(theta)) if i not in drives]
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


def _generic_jacobian(tree: Tree, theta: np.ndarray) -> np.ndarray:
    """The gaps' Jacobian of highest rank among closed postures near `theta`, which may be a dead point."""
    generator = np.random.default_rng(_SEED)
    tree.move(theta)
    best = tree.gap_jacobian()
    if best.size == 0:
        return best
    _, values, v = np.linalg.svd(best)
    tangents = v[int(np.sum(values > DEAD * values[0])) :]
    for _ in range(4):
        near = _close(tree, theta + 0.2 * generator.standard_normal(len(tangents)) @ tangents)
        if near is not None:
            tree.move(near)
            jacobian = tree.gap_jacobian()
            best = jacobian if _rank(jacobian) > _rank(best) else best
    return best


def _rank(matrix: np.ndarray) -> int:
    if matrix.size == 0:
        return 0
    values = np.linalg.svd(matrix, compute_uv=False)
    return int(np.sum(values > 1e-7 * values[0]))


def _loose(gap_d: np.ndarray) -> np.ndarray:
    """Which dependent coordinates move in some way that keeps the loops closed."""
    if gap_d.shape[1] == 0:
        return np.zeros(0, bool)
    free = np.linalg.svd(gap_d)[2][_rank(gap_d) :] if gap_d.size else np.eye(gap_d.shape[1])
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
