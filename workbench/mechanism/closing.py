"""Loops closed for the first time, as near the start posture as that allows.

Loops that share no coordinate are closed one group after the other: of both legs of a robot each finds its
way however the other begins.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import InputError
from workbench.core.closure import CLOSED
from workbench.core.moving import groups

from .tree import Tree

_SEED = 7  # what is random here has to come out the same every time
_STRAYED = 0.2  # rad or m from what was stated of the start: still that posture
_HELD, _HINTED, _TRIES, _ENOUGH = 0.05, 0.2, 40, 12
_FAR = 1e6  # m: a file with a wrong number
_LOST = 200  # steps of the damped way, which is for those that begin far from any closed posture


@dataclass(frozen=True)
class _Group:
    """Loops that move together: their rows of the gap, and the coordinates that move them."""

    rows: list[int]
    coordinates: list[int]


def closed_near_start(tree: Tree, drives: Sequence[int]) -> np.ndarray:
    """Return the closed posture (N,) nearest to the mechanism's start posture; it may be a dead point.

    Args:
        tree: the cut mechanism.
        drives: positions in theta of the driven joints, and of others that stay near where they begin.

    Raises:
        InputError: the loops do not close there.
    """
    start = _start(tree)
    kept = {*drives, *(tree.index(name, "joints") for name in tree.mechanism.joints)}
    chosen = {tree.index(name, "start") for name, _ in tree.mechanism.start}
    rest = {tree.index(name, "start") for name, _ in tree.mechanism.rest}
    theta = start.copy()
    for group in _groups(tree):
        if chosen & set(group.coordinates):  # somebody's choice goes before the posture of the file
            closed = _group_near_start(tree, group, theta, chosen, kept, rest - chosen)
        else:
            closed = _group_near_start(tree, group, theta, rest, kept)
        if closed is None:
            close(tree, start)  # which leaves the tree as near as it comes
            raise InputError(
                f"the loops do not close near the start posture: {_gap_text(tree)}",
                file=tree.mechanism.file, column="closed_chain.start",
                remedy="give the joints' angles near a closed posture",
            )  # fmt: skip
        theta = closed
    return theta


def close(
    tree: Tree, theta: np.ndarray, ease: np.ndarray | float = 1.0, group: _Group | None = None
) -> np.ndarray | None:
    """Gauss-Newton over all coordinates, which moves them as little as it can; None if it does not close.

    Args:
        tree: the cut mechanism; it is left where this ends.
        theta: where to begin (N,).
        ease: how readily each coordinate gives way (N,).
        group: of a group of loops alone.
    """
    theta = theta.copy()
    rows, columns = _of(tree, group)
    give = np.broadcast_to(ease, theta.shape)[columns]
    for _ in range(60):
        tree.move(theta)
        gap = tree.gap(rows)
        if np.abs(gap).max(initial=0.0) < 1e-15:
            return theta
        jacobian = tree.gap_jacobian(rows)[:, columns]
        step = give * np.linalg.lstsq(jacobian * give, gap, rcond=1e-12)[0]
        size = np.abs(step).max()
        theta[columns] -= step * min(1.0, 0.5 / max(size, 1e-300))  # half a radian at most
        if size < 1e-12:
            break
    tree.move(theta)
    return theta if np.abs(tree.gap(rows)).max() < CLOSED else None


def _group_near_start(
    tree: Tree, group: _Group, start: np.ndarray, stated: set[int], kept: set[int],
    hints: Collection[int] = (),
) -> np.ndarray | None:  # fmt: skip
    """The nearest closed posture of one group of loops, the other coordinates as in `start` (N,).

    Loops close in more than one way, and from the angles that nobody stated the nearest way may lead far from
    those that somebody did. Then passive coordinates are begun all round, and what was stated is held.
    Drives and serial joints stay near `hints` where `stated` allows that: with a crank held at the angle that
    somebody chose, the old way to put a leg together closes too, with its hip turned round.
    """
    own = [i for i in group.coordinates if i in stated]
    near = [i for i in group.coordinates if i in kept and i in hints]
    ease = np.ones(len(start))
    ease[near], ease[own] = _HINTED, _HELD
    plain = None
    for given in (ease, 1.0) if own else (1.0,):
        plain = close(tree, start, given, group)
        if plain is not None and np.abs(plain - start)[own + near].max(initial=0.0) < _STRAYED:
            return plain
    serial = [tree.index(name, "joints") for name in tree.mechanism.joints]
    passive = [i for i in group.coordinates if i not in stated | kept]
    free = [i for i in group.coordinates if i not in {*stated, *serial}]
    generator, found = np.random.default_rng(_SEED), [] if plain is None else [plain]
    for turn in range(_TRIES):
        # a drive that nobody spoke of may have to go to the other side as well
        turned = free if near and turn % 2 else passive
        guess = start.copy()
        guess[turned] += generator.uniform(-np.pi, np.pi, len(turned))
        closed = close(tree, guess, ease, group)
        if closed is None and not found and np.isfinite(tree.gap(group.rows)).all():
            damped = _approached(tree, guess, ease, group)
            closed = close(tree, damped, ease, group)
        found += [] if closed is None else [_unturned(tree, group, closed, start)]
        if len(found) == _ENOUGH:
            break
    cost = np.zeros(len(start))
    cost[list(hints)] = _HELD**2
    cost[list(kept)], cost[own] = _HELD, 1.0
    low, high = np.array(tree.mechanism.limits or [(-np.inf, np.inf)] * len(serial)).T

    def dear(theta: np.ndarray) -> float:
        beyond = theta[serial] - np.clip(theta[serial], low, high)
        return float(cost @ (theta - start) ** 2 + beyond @ beyond)

    return min(found, key=dear, default=None)


def _unturned(tree: Tree, group: _Group, theta: np.ndarray, start: np.ndarray) -> np.ndarray:
    """The same posture (N,), without whole turns away from `start` if the loops are closed there too."""
    turning = [i for i in group.coordinates if tree.unit(tree.names[i]) == "rad"]
    near = theta.copy()
    near[turning] -= 2.0 * np.pi * np.round((theta - start)[turning] / (2.0 * np.pi))
    tree.move(near)
    return near if np.abs(tree.gap(group.rows)).max() < CLOSED else theta


def _approached(tree: Tree, theta: np.ndarray, ease: np.ndarray, group: _Group) -> np.ndarray:
    """A posture (N,) in which the gaps are least, downhill from `theta` in damped steps."""
    theta = theta.copy()
    rows, columns = _of(tree, group)
    give, damping = ease[columns], 1e-2
    tree.move(theta)
    gap = tree.gap(rows)
    if not np.abs(gap).max() < _FAR:
        return theta
    for _ in range(_LOST):
        jacobian = tree.gap_jacobian(rows)[:, columns] * give
        square = jacobian.T @ jacobian
        step = np.linalg.solve(square + damping * np.eye(len(columns)), jacobian.T @ gap)
        tried = theta.copy()
        tried[columns] -= give * step
        tree.move(tried)
        new = tree.gap(rows)
        if new @ new < gap @ gap:
            better = 1.0 - (new @ new) / (gap @ gap)
            theta, gap, damping = tried, new, max(damping / 5.0, 1e-12)
            if better < 1e-9 or np.abs(gap).max() < 1e-6:
                break
        else:
            damping *= 5.0
            tree.move(theta)
            if damping > 1e6:
                break
    return theta


def _of(tree: Tree, group: _Group | None) -> tuple[list[int], list[int]]:
    if group is not None:
        return group.rows, group.coordinates
    return list(range(len(tree.gap()))), list(range(len(tree.names)))


def _groups(tree: Tree) -> list[_Group]:
    """The loops by which coordinates they share."""
    return [_Group(*each) for each in groups(tree.movers())]


def _start(tree: Tree) -> np.ndarray:
    theta = np.zeros(len(tree.names))
    for name, value in (*tree.mechanism.rest, *tree.mechanism.start):
        if not np.isfinite(value):
            raise InputError(
                f"the start of '{name}' is {value}", file=tree.mechanism.file, column="closed_chain.start",
                remedy="give a number",
            )  # fmt: skip
        theta[tree.index(name, "start")] = value
    return theta


def _gap_text(tree: Tree) -> str:
    with np.errstate(over="ignore"):  # an infinite gap is one that stays open too
        gaps = tree.open_loops()
        if not gaps.size:
            return "a joint that follows another cannot reach its position"
    return f"{gaps.max():.3g} m stay open at loop {int(gaps.argmax()) + 1}"
