"""A function of the posture as the length of a tendon in space: a drive's position without a loop.

A tendon's length may be a sum of branches, each the distance between a point on one body and a point on
another times a weight. MuJoCo has all that a drive needs on a tendon: inertia with its velocity term, drag, a
motor through J^T. Its bodies stay a serial tree, and nothing is computed at any step. What distances can be
added up to is not every function, but a drive of a mechanism moves by distances itself, so a few come near.

First nonnegative least squares picks from many random distances (a convex problem, so there is no bad start),
then Levenberg and Marquardt's method moves the points of the strongest few.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.optimize import least_squares, nnls

from .posture_frames import Frames

_CANDIDATES = 800
_SHORT = (
    0.25  # of its greatest length: a branch that gets shorter turns too fast to be trusted between postures
)
_FAR = 1e-4  # weight of points' distances [sizes] beside relative errors: nothing is far away for nothing
# of a candidate's share, by start: of many that would do the same, the choice must not hang on rounding
_PRICES = 1e-3, 1e-2, 0.0
_RATE = 0.2  # rad: weight of the gradient's slope beside the gradient, v^2 / a of a brisk motion
_ROUNDS = 300


@dataclass(frozen=True)
class Branches:
    """Distances that add up: bodies (K, 2) and points (K, 2, m) of their ends, weights (K,)."""

    bodies: np.ndarray
    points: np.ndarray
    weights: np.ndarray

    def length(self, f: Frames) -> np.ndarray:
        """(N,)."""
        at, _ = self._ends(f)
        return self.weights @ np.linalg.norm(at[:, 0] - at[:, 1], axis=-1)

    def gradient(self, f: Frames) -> np.ndarray:
        """To the joints (N, n)."""
        return np.einsum("k,kni->ni", self.weights, self.gradients(f)[1])

    def gradients(self, f: Frames) -> tuple[np.ndarray, np.ndarray]:
        """Distances (K, N) and their gradients to the joints (K, N, n)."""
        at, jacobian = self._ends(f)
        apart = at[:, 0] - at[:, 1]
        distance = np.linalg.norm(apart, axis=-1)
        along = apart / distance[..., None]
        return distance, np.einsum("kni,knij->knj", along, jacobian[:, 0] - jacobian[:, 1])

    def slopes(self, f: Frames) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives to the ends' coordinates: of distances (K, N, 2 m), of gradients (K, N, n, 2 m)."""
        at, jacobian = self._ends(f)
        apart = at[:, 0] - at[:, 1]
        distance = np.linalg.norm(apart, axis=-1)
        along = apart / distance[..., None]
        across = (np.eye(3) - along[..., :, None] * along[..., None, :]) / distance[..., None, None]
        relative = across @ (jacobian[:, 0] - jacobian[:, 1])
        lengths, gradients = [], []
        for end, sign in ((0, 1.0), (1, -1.0)):
            shift, turned = f.shift[self.bodies[:, end]], f.jacobian_shift[self.bodies[:, end]]
            lengths.append(sign * np.einsum("kni,knim->knm", along, shift))
            moved = np.einsum("kni,knijm->knjm", along, turned)
            gradients.append(sign * (moved + np.einsum("knij,knim->knjm", relative, shift)))
        return np.concatenate(lengths, axis=-1), np.concatenate(gradients, axis=-1)

    def _ends(self, f: Frames) -> tuple[np.ndarray, np.ndarray]:
        count, _, ways = self.points.shape
        at, jacobian = f.place(self.bodies.ravel(), self.points.reshape(-1, ways))
        return at.reshape(count, 2, *at.shape[1:]), jacobian.reshape(count, 2, *jacobian.shape[1:])


@dataclass(frozen=True)
class Goal:
    """The gradient that a tendon should have, at N postures.

    Attributes:
        frames: of the bodies.
        gradient: to the joints (N, n).
        metric: (N, n, n); what counts is ``metric @ (gradient' - gradient)``, relative.
        slopes: matrices (N, N) that differentiate a function of the postures to each joint: velocity terms
            come from how the gradient changes.
        size: of the mechanism [m].
    """

    frames: Frames
    gradient: np.ndarray
    metric: np.ndarray
    slopes: tuple[np.ndarray, ...]
    size: float


def fit_length(goal: Goal, branches: int, seed: int) -> tuple[Branches, float]:
    """Return the branches whose summed length has the gradient nearest to the wanted one, and the error left.

    Args:
        goal: the gradient.
        branches: at most so many.
        seed: of what there is to choose from.

    Returns:
        ``(branches, error)``: and the largest error, relative to the root mean square of what is wanted.
    """
    scale = float(np.sqrt(np.mean(np.sum(_turned(goal.metric, goal.gradient) ** 2, axis=1))))
    problem = _Problem(replace(goal, metric=goal.metric / scale))
    start = problem.choose(branches, seed)
    x = least_squares(
        lambda x: problem.at(x)[0],
        problem.pack(start),
        jac=lambda x: problem.at(x)[1],  # pyright: ignore[reportArgumentType]  (its stub says str)
        method="lm",
        x_scale="jac",
        max_nfev=_ROUNDS,
    ).x
    found = problem.unpack(x)
    off = _turned(goal.metric / scale, found.gradient(goal.frames) - goal.gradient)
    return found, float(np.linalg.norm(off, axis=1).max())


class _Problem:
    """The misfit and its derivatives; weights are squares, so that none becomes negative."""

    def __init__(self, goal: Goal) -> None:
        self.goal, self.bodies = goal, np.empty((0, 2), int)
        self._known: tuple[bytes, np.ndarray, np.ndarray] | None = None

    def choose(self, count: int, seed: int) -> Branches:
        goal, f, generator = self.goal, self.goal.frames, np.random.default_rng(seed)
        pairs = np.array(list(combinations(range(len(f.bodies)), 2)))
        bodies = pairs[generator.integers(len(pairs), size=_CANDIDATES)]
        spread = goal.size * generator.choice([0.3, 1.0, 3.0], size=(_CANDIDATES, 1, 1))
        points = spread * generator.standard_normal((_CANDIDATES, 2, f.ways))
        many = Branches(bodies, points, np.ones(_CANDIDATES))
        distance, gradients = many.gradients(f)
        good = distance.min(axis=1) > 1.2 * _SHORT * distance.max(axis=1)
        columns = _turned(goal.metric, gradients[good]).reshape(good.sum(), -1).T
        weights = strongest(
            columns, _turned(goal.metric, goal.gradient).ravel(), count, _PRICES[seed % len(_PRICES)]
        )
        kept = np.flatnonzero(good)[weights > 0.0]
        self.bodies = bodies[kept]
        return Branches(bodies[kept], points[kept], weights[weights > 0.0])

    def pack(self, b: Branches) -> np.ndarray:
        return np.concatenate(
            [b.points.reshape(len(b.weights), -1), np.sqrt(b.weights)[:, None]], axis=1
        ).ravel()

    def unpack(self, x: np.ndarray) -> Branches:
        rows = x.reshape(len(self.bodies), -1)
        return Branches(self.bodies, rows[:, :-1].reshape(len(rows), 2, -1), rows[:, -1] ** 2)

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (R,) and their derivatives (R, X)."""
        if self._known is None or self._known[0] != x.tobytes():
            self._known = (x.tobytes(), *self._compute(x))
        return self._known[1], self._known[2]

    def _compute(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        b, goal = self.unpack(x), self.goal
        count, share = len(b.weights), 1.0 / np.sqrt(len(goal.gradient))
        distance, gradients = b.gradients(goal.frames)
        distance_slope, slope = b.slopes(goal.frames)
        roots = x.reshape(count, -1)[:, -1]
        off = np.einsum("k,kni->ni", b.weights, gradients) - goal.gradient
        columns = np.concatenate(
            [b.weights[:, None, None, None] * slope, 2.0 * (roots[:, None, None] * gradients)[..., None]],
            axis=-1,
        )
        columns = columns.transpose(1, 2, 0, 3).reshape(*off.shape, -1)
        gap, opened = _gaps(distance, distance_slope)
        residuals = [gap, _FAR / goal.size * x]
        slopes = [opened, _FAR / goal.size * np.eye(len(x))]
        for d in (None, *goal.slopes):
            weight = share if d is None else share * _RATE
            own = off if d is None else d @ off
            turned = columns if d is None else (d @ columns.reshape(len(off), -1)).reshape(columns.shape)
            residuals.append(weight * _turned(goal.metric, own).ravel())
            slopes.append(weight * (goal.metric @ turned).reshape(-1, len(x)))
        return np.concatenate(residuals), np.concatenate(slopes)


def _gaps(distance: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how much shorter than the least length branches are (K,), and derivatives to all (K, X).

    Args:
        distance: (K, N).
        slope: to the coordinates of a branch's own ends (K, N, 2 m).
    """
    count, ways = len(distance), slope.shape[-1] + 1
    out, slopes = np.zeros(count), np.zeros((count, count, ways))
    for k in range(count):
        least, most = distance[k].argmin(), distance[k].argmax()
        allowed = _SHORT * distance[k, most]
        share = distance[k, least] / allowed
        if share < 1.0:
            out[k] = 1.0 - share
            slopes[k, k, :-1] = (share * _SHORT * slope[k, most] - slope[k, least]) / allowed
    return out, slopes.reshape(count, -1)


def strongest(
    columns: np.ndarray, wanted: np.ndarray, count: int | None = None, price: float = 0.0
) -> np.ndarray:
    """Return nonnegative weights (K,) for which ``columns @ weights`` is nearest to `wanted`.

    With `count` at most so many are not zero: the weakest go, some at a time, and the rest are found anew.
    The `price` of a weight, in the scale of its column, makes them unique where several sets would do.
    """
    size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    kept = np.arange(columns.shape[1])
    while True:
        priced = np.concatenate([columns[:, kept] / size[kept], price * np.eye(len(kept))])
        rows = priced if price else priced[: len(wanted)]
        padded = np.concatenate([wanted, np.zeros(len(rows) - len(wanted))])
        weights = nnls(rows, padded, maxiter=100 * len(kept))[0]
        kept, weights = kept[weights > 0.0], weights[weights > 0.0]
        over = 0 if count is None else len(kept) - count
        if over <= 0:
            out = np.zeros(columns.shape[1])
            out[kept] = weights / size[kept]
            return out
        kept = np.delete(kept, np.argsort(weights)[: max(1, over // 4)])


def _turned(metric: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return the metric (N, n, n) applied to vectors (..., N, n)."""
    return np.einsum("nij,...nj->...ni", metric, vectors)
