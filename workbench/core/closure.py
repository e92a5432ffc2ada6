"""Closed loops: the dependent coordinates of a tree, solved for given independent ones.

With independent coordinates q and dependent ones d, and the gaps phi(theta) of all loops,

    theta_dot  = L q_dot,            L = [I; -phi_d^+ phi_q]
    theta_ddot = L q_ddot + gamma,   gamma = [0; -phi_d^+ (phi_dot_theta theta_dot)]     (the L' term)

phi_d^+ is the pseudo-inverse: in a planar mechanism one of the three equations of a loop says nothing, and
which one it is need not be known. Where phi_d loses rank (a dead point) the independent coordinates do not
determine the others; a loop can have two solutions there, so a solution is followed from a known posture
along L and never looked for afresh: that keeps it on the branch of the start posture.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from .errors import SimulationError

#: Ratio of smallest to largest singular value below which a posture counts as a dead point.
DEAD = 1e-9
#: Largest gap [m] that counts as closed.
CLOSED = 1e-10

_NEAR = 0.2  # a posture this close [rad or m] to the last one is followed from there, else from the start
_SHORTEST = 2.0**-12  # part of the way below which following gives up
_EXACT = 1e-9  # a prediction this good [rad or m] may pass through a dead point, as a parallelogram does


class _Tree(Protocol):
    """The cut mechanism at one posture and speed in any simulator: N coordinates, m loops, k couplings."""

    @property
    def names(self) -> Sequence[str]: ...
    def move(self, theta: np.ndarray) -> None: ...
    def gap(self, rows: Sequence[int] | None = None) -> np.ndarray: ...  # (3 m + k,) [m or rad]
    def gap_jacobian(self, rows: Sequence[int] | None = None) -> np.ndarray: ...  # (3 m + k, N)
    def gap_bias(self, rows: Sequence[int] | None = None) -> np.ndarray: ...  # at zero theta''


@dataclass(frozen=True)
class Posture:
    """A closed posture.

    Attributes:
        q: independent coordinates (n,) [rad or m].
        theta: all coordinates (N,).
        gap_d: d gap / d dependent coordinates (3 m, N - n).
        inverse: its pseudo-inverse (N - n, 3 m), or None at a dead point.
        slope: L (N, n), or None at a dead point.
        margin: smallest over largest singular value of `gap_d`; zero at a dead point.
    """

    q: np.ndarray
    theta: np.ndarray
    gap_d: np.ndarray
    inverse: np.ndarray | None
    slope: np.ndarray | None
    margin: float


class Closure:
    """The loops of `tree`, solved for all coordinates except `independent`.

    Args:
        tree: the cut mechanism; it is moved about.
        independent: positions in theta of the independent coordinates, length n.
        start: a closed posture (N,) that is no dead point; the branch it lies on is kept.
        through: whether the way may lead straight through a dead point, as that of a parallelogram.
        moving: rows of the gap and coordinates of the loops that move with these; all others stay where
            they are in `start`, as those of another limb do, and cost nothing.
    """

    def __init__(
        self, tree: _Tree, independent: Sequence[int], start: np.ndarray, *, through: bool = True,
        moving: tuple[Sequence[int], Sequence[int]] | None = None,
    ) -> None:  # fmt: skip
        self._rows, columns = moving or (None, range(len(start)))
        self.independent = list(independent)
        self.dependent = [i for i in columns if i not in self.independent]
        self._tree, self._through = tree, through
        self._start = self._last = self._posture(np.array(start, float))

    def at(self, q: np.ndarray) -> Posture:
        """Return the closed posture at independent coordinates `q` (n,); the tree stays in that posture.

        Raises:
            SimulationError: the loops cannot be closed there.
        """
        if not np.array_equal(q, self._last.q):
            if not np.isfinite(q).all():
                raise SimulationError(f"not finite: {self.say(q)}")
            self._last = self._reach(np.array(q, float))
        self._tree.move(self._last.theta)
        return self._last

    def along(self, origin: Posture, q: np.ndarray) -> Posture | None:
        """Return the closed posture at `q` (n,), straight from `origin`; None where the loops open."""
        return self._follow(origin, q)

    def regular(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return theta (N,), L (N, n) and the pseudo-inverse of phi_d (N - n, 3 m) at `q` (n,).

        Raises:
            SimulationError: the loops cannot be closed there, or are at a dead point.
        """
        posture = self.at(q)
        if posture.slope is None or posture.inverse is None:
            raise SimulationError(f"the loops are at a dead point at {self.say(q)}")
        return posture.theta, posture.slope, posture.inverse

    def gamma(self, inverse: np.ndarray) -> np.ndarray:
        """The acceleration of the tree (N,) at zero acceleration of q, at its current posture and speed."""
        gamma = np.zeros(len(self._last.theta))
        gamma[self.dependent] = -inverse @ self._tree.gap_bias(self._rows)
        return gamma

    def say(self, q: np.ndarray) -> str:
        """Return the independent coordinates with their names, for messages."""
        names = [self._tree.names[i] for i in self.independent]
        return ", ".join(f"{name} = {value:.4g}" for name, value in zip(names, q, strict=True))

    def solve(self, theta: np.ndarray) -> np.ndarray | None:
        """Solve for the dependent coordinates from the guess `theta` (N,); None if the loops do not close."""
        theta = theta.copy()
        for _ in range(12):
            self._tree.move(theta)
            gap = self._tree.gap(self._rows)
            if np.abs(gap).max(initial=0.0) < 1e-15:
                return theta
            gap_d = self._tree.gap_jacobian(self._rows)[:, self.dependent]
            step = np.linalg.lstsq(gap_d, gap, rcond=1e-12)[0]
            theta[self.dependent] -= step
            size = np.abs(step).max(initial=0.0)
            if size < 1e-9:  # Newton converges quadratically: this step leaves rounding only
                return theta if np.abs(gap).max() < CLOSED else None
            if not size < 10.0:
                return None
        return None

    def _reach(self, q: np.ndarray) -> Posture:
        """Solve from the last posture if it is near, otherwise from the start; if that fails, by detours."""
        if self._start.slope is None and not np.array_equal(q, self._start.q):
            where = self.say(self._start.q)
            raise SimulationError(f"the start posture is a dead point, {where}: give another")
        near = np.abs(q - self._last.q).max() < _NEAR
        origins = (self._last, self._start) if near else (self._start, self._last)
        for origin in origins:
            for route in _routes(origin.q, q):
                posture: Posture | None = origin
                for target in route:
                    posture = posture and self._follow(posture, target)
                if posture is not None:
                    return posture
        raise SimulationError(f"the loops cannot be closed at {self.say(q)}")

    def _follow(self, origin: Posture, q: np.ndarray) -> Posture | None:
        """Follow the solution along L, in steps short enough for a good prediction."""
        posture, slope, done, step = origin, origin.slope, 0.0, 1.0
        while done < 1.0:
            target = q if done + step >= 1.0 else origin.q + (done + step) * (q - origin.q)
            found = self._step(posture, slope, target)
            if found is None:
                step /= 2.0
                if step < _SHORTEST:
                    return None
                continue
            done = done + step
            step = min(2.0 * step, 1.0 - done) if done < 1.0 else 0.0
            posture = found
            slope = slope if found.slope is None else found.slope  # go on straight through a dead point
        return posture

    def _step(self, posture: Posture, slope: np.ndarray | None, q: np.ndarray) -> Posture | None:
        """Return one step of the path, or None if the prediction was too poor to stay on the branch."""
        if slope is None:
            return None
        predicted = posture.theta + slope @ (q - posture.q)
        predicted[self.independent] = q
        theta = self.solve(predicted)
        if theta is None:
            return None
        off = np.abs(theta - predicted).max()
        if off > 0.2 * np.abs(predicted - posture.theta).max():
            return None
        found = self._posture(theta)
        same_side = np.linalg.det(posture.gap_d.T @ found.gap_d) > 0.0
        return found if same_side or (self._through and off < _EXACT) else None

    def _posture(self, theta: np.ndarray) -> Posture:
        self._tree.move(theta)
        jacobian = self._tree.gap_jacobian(self._rows)
        gap_d, q = jacobian[:, self.dependent], theta[self.independent]
        if gap_d.shape[1] == 0:
            return Posture(q, theta, gap_d, gap_d.T, np.eye(len(theta))[:, self.independent], 1.0)
        u, values, v = np.linalg.svd(gap_d, full_matrices=False)
        margin = float(values[-1] / values[0]) if len(values) == gap_d.shape[1] and values[0] > 0.0 else 0.0
        if margin < DEAD:
            return Posture(q, theta, gap_d, None, None, margin)
        inverse = (v.T / values) @ u.T
        slope = np.zeros((len(theta), len(self.independent)))
        slope[self.independent, range(len(self.independent))] = 1.0
        slope[self.dependent] = -inverse @ jacobian[:, self.independent]
        return Posture(q, theta, gap_d, inverse, slope, margin)


def _routes(origin: np.ndarray, q: np.ndarray) -> Iterator[list[np.ndarray]]:
    """Return paths: straight, then one coordinate at a time (a workspace need not be convex)."""
    yield [q]
    moved = [i for i in range(len(q)) if q[i] != origin[i]]
    if len(moved) < 2:  # that was straight already
        return
    for order in (moved, moved[::-1]):
        corner, corners = origin.copy(), []
        for i in order:
            corner = corner.copy()
            corner[i] = q[i]
            corners.append(corner)
        yield corners
