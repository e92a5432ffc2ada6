"""What passes through a gap along a motion, and the gap that foresees it best.

A path across a gap cannot be followed for long. So the state is drawn to what the motor's torque and
acceleration say passes through, and by how much it has to be drawn tells how far a gap is from the true one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from workbench.core.compiled import compiled
from workbench.models import Model, Placement

from .flexible import transmitted
from .lacking import lacking
from .motion import Motion

_RATE = 180.0  # rad/s: how fast the state follows the torque that passed
_MEAN_S = 0.016  # over which acceleration, noisy from row to row, is averaged
_SLOW_S = 0.05  # what is slower than this the state follows, whatever it is
_OWN = 0.7  # of the slow torque that is lacking: what the state may be drawn by
_SETTLED_S = 0.2  # from which on the state has come to where it belongs
_BLOWN_UP = 1e300  # left by what cannot be followed at all; infinities have no differences
_SIMPLEX = np.diag([0.4, 0.2, 0.4])  # of logarithms
_RATIOS = (0.05, 0.2, 0.6)  # of damping that are tried; below
_MOST = 1.5  # of it: a rotor that is damped more meets a flank no softer
_SOFT = 1e-3  # of the softest spring to begin with: softer ones couple nothing
_BANDS = 3  # of gaps: a start in each
_SHORT, _LONG = 40, 100  # tries from a start, and at last
_DAMPED = 0.95  # of what elastic flanks leave


@dataclass(frozen=True)
class Passage:
    """One motion of an axis for a gap behind its motor, or in its pin.

    Attributes:
        step: of the rows [s].
        load: torque that would pass through rigid links, (N,).
        passed: torque that passed as rotor and motor torque say, (N,).
        known: rows (N,) on which it is known what passed.
    """

    step: float
    load: np.ndarray
    passed: np.ndarray
    known: np.ndarray

    @staticmethod
    def of(motion: Motion, model: Model, place: Placement) -> Passage:
        """Return it along a motion, for a model that has no gap."""
        load, index = transmitted(motion, model, place), place.index
        return Passage(motion.step, load, load - lacking(motion, model)[:, index], motion.known[:, index])

    def unforeseen(self, inertia: float, gap: float, stiffness: float, retardation: float) -> np.ndarray:
        """Return the transmitted torque minus the prediction of a gap, (N,); on all rows.

        Args:
            inertia: of the links.
            gap: from flank to flank.
            stiffness: of either flank, and its damping over it, `retardation` [s].
        """
        error = np.empty_like(self.load)
        _observe(
            self.load, self.passed, self.known, self.step, inertia, gap, stiffness, retardation, _RATE, error
        )
        return error

    def unforeseen_means(
        self, inertia: float, gap: float, stiffness: float, retardation: float, seconds: float = _MEAN_S
    ) -> np.ndarray:
        """Return means of it over some time, (M,), by which gaps are compared; unknown rows add nothing."""
        return self.means(self.unforeseen(inertia, gap, stiffness, retardation), seconds)

    def means(self, values: np.ndarray, seconds: float) -> np.ndarray:
        """Return means of values (N,) over some time, (M,), once the state has settled."""
        rows = max(1, round(seconds / self.step))
        known = np.where(self.known, values, 0.0)[int(_SETTLED_S / self.step) :]
        return known[: len(known) // rows * rows].reshape(-1, rows).mean(axis=1)

    def with_torque(self, torque: np.ndarray, at_motor: bool) -> Passage:
        """Return the same with one more torque (N,), on the motor or on the links."""
        if at_motor:
            return replace(self, passed=self.passed + torque)
        return replace(self, load=self.load - torque)


def foresees(
    pieces: Sequence[Passage], inertia: float, gap: float, stiffness: float, retardation: float
) -> bool:
    """Return whether a gap predicts the position of its links by itself, without correction by the explained
    torque.

    On soft flanks the state follows any slow torque, and would explain friction as well. As a torque on the
    links the draw is rate^2 inertia / stiffness times what was unforeseen.
    """
    pull = 1.0 + _RATE**2 * inertia / stiffness / (1.0 + 0.5 * _RATE * retardation)
    drawn = lacked = 0.0
    for piece in pieces:
        error = piece.unforeseen_means(inertia, gap, stiffness, retardation, _SLOW_S)
        with np.errstate(over="ignore"):  # a draw beyond all numbers is more than what is lacking
            drawn += pull**2 * float(np.sum(error**2))
        lacked += float(np.sum(piece.means(piece.load - piece.passed, _SLOW_S) ** 2))
    return drawn < _OWN**2 * lacked


def best_gap(
    pieces: Sequence[Passage],
    inertia: float,
    rotor: float,
    gaps: np.ndarray,
    stiffnesses: np.ndarray,
    stiffest: float,
) -> tuple[float, float, float, float]:
    """Return the gap with the smallest prediction error; with damped flanks only if these are clearly
    better.

    Args:
        pieces: motions.
        inertia, rotor: of the links, and of what the motor turns.
        gaps, stiffnesses: to begin with, (G,) and (S,).
        stiffest: what is as good as rigid, and dear to follow.

    Returns:
        Gap, stiffness, retardation [s], and the squared torque that is left.
    """

    softest = _SOFT * float(stiffnesses.min())

    def physical(x: np.ndarray) -> tuple[float, float, float]:
        """Gap, stiffness, retardation; from the damping over what stops the rotor's ringing on a flank."""
        stiffness = min(max(float(x[1]), softest), stiffest)
        return float(x[0]), stiffness, 2.0 * min(float(x[2]), _MOST) * (rotor / stiffness) ** 0.5

    def left(x: np.ndarray) -> float:
        return left_by(pieces, inertia, *physical(x))

    elastic = _downhill(left, min(_grid(gaps, stiffnesses, (0.0,)), key=left), 2, _LONG)
    starts = [
        min(_grid(some, stiffnesses, (ratio,)), key=left)
        for some in np.array_split(gaps, _BANDS)
        for ratio in _RATIOS
    ]
    starts += [np.append(elastic[:2], ratio) for ratio in _RATIOS]
    near = min((_downhill(left, start, 3, _SHORT) for start in starts), key=left)
    damped = _downhill(left, near, 3, _LONG)
    found = damped if left(damped) < _DAMPED * left(elastic) else elastic
    return *physical(found), left(found)


def left_by(
    pieces: Sequence[Passage], inertia: float, gap: float, stiffness: float, retardation: float
) -> float:
    """Return the squared torque that a gap does not predict."""
    means = (p.unforeseen_means(inertia, gap, stiffness, retardation) for p in pieces)
    with np.errstate(over="ignore", invalid="ignore"):
        left = [float(m @ m) for m in means]
    return sum(each if each < _BLOWN_UP else _BLOWN_UP for each in left)


def _grid(*values: Sequence[float] | np.ndarray) -> np.ndarray:
    """All combinations, one per row."""
    return np.stack(np.meshgrid(*values, indexing="ij"), axis=-1).reshape(-1, len(values))


def _downhill(left: Callable[[np.ndarray], float], start: np.ndarray, free: int, most: int) -> np.ndarray:
    """The values near a start that leave least, in `most` tries; the first `free` of them may move."""
    simplex = np.log(start[:free]) + np.vstack([np.zeros(free), _SIMPLEX[:free, :free]])
    found = minimize(
        lambda x: left(np.append(np.exp(x), start[free:])),
        simplex[0],
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "xatol": 1e-3, "fatol": np.inf, "maxfev": most},
    )
    return np.append(np.exp(found.x), start[free:])


@compiled(nogil=True, fastmath={"contract"})
def _observe(load, passed, known, step, inertia, gap, stiffness, retardation, bandwidth, error):  # pyright: ignore
    """Follow the wind d between motor and links: inertia d'' = load - k dead(d) - k t d' where they touch.

    The state is drawn to where the torque that `passed` says that it is, as fast with damped flanks as with
    others; where that is not `known` nothing draws it. Semi-implicit Euler, in steps that follow the
    contact; `error` (N,) is `passed` less the torque that was foreseen.
    """
    many = int(np.ceil(step * np.sqrt(stiffness / inertia) / 0.3))
    h, half = step / many, 0.5 * gap
    push = h / inertia
    spring, damper = push * stiffness, push * stiffness * retardation
    pull = bandwidth * step / stiffness / (1.0 + 0.5 * bandwidth * retardation)
    wind, rate = np.sign(passed[0]) * half + passed[0] / stiffness, 0.0
    for row in range(len(load)):
        into = wind - min(max(wind, -half), half)
        damped = retardation * rate if into != 0.0 else 0.0
        away = passed[row] - stiffness * (into + damped)
        error[row] = away
        if not known[row]:
            away = 0.0
        wind += 2.0 * pull * away
        rate += bandwidth * pull * away
        driven = push * load[row]
        for _ in range(many):
            into = wind - min(max(wind, -half), half)
            slowed = damper if into != 0.0 else 0.0
            rate += driven - spring * into - slowed * rate
            wind += h * rate
