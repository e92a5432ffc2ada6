"""How a foot sinks under the force that a plate measures: stiffness and damping of the ground.

`improve` fits both by running the model in short windows from measured states, and leaves out the rows in
which a foot lands, since no log tells where in a row that is. What is left shows less of the damping.

The force on a plate is far more exact than what encoders say of the depth of a foot. So the force is taken
for given here, and the depth that it makes is held against the encoders, row by row. Noise is then in what is
compared alone, and pulls no parameter; what a landing does in the rows after it counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

from workbench.comparison.feet import Feet
from workbench.core import Recording
from workbench.effects import compile_plant
from workbench.models import Model

_TOUCHES = 6.0  # of the force's noise
_START = 3e4, 100.0  # N/m, N s/m
_SCALE = 1e-5  # m: about what encoders tell of a depth


@dataclass(frozen=True)
class Sinking:
    """A ground's law and the halves of its 95 % intervals, by the noise of the depths.

    Attributes:
        stiffness, damping: [N/m, N s/m].
        stiffness_half, damping_half: [N/m, N s/m].
    """

    stiffness: float
    damping: float
    stiffness_half: float
    damping_half: float


def sinking(leg: Model, recordings: Sequence[Recording], noise: float) -> Sinking:
    """Return the law of the ground from one leg's recordings on a plate, with one foot.

    Args:
        leg: the model, whose ground says where foot and plate are.
        recordings: with `ground_force` (N, 3).
        noise: standard deviation of the force [N].
    """
    runs = [_Run.of(leg, r, noise) for r in recordings]

    def missed(x: np.ndarray) -> np.ndarray:
        k, c, offset = np.exp(x[0]), np.exp(x[1]), _SCALE * x[2]
        return np.concatenate([(r.depth - r.sunk(k, c) - offset)[r.used] for r in runs]) / _SCALE

    fit = least_squares(missed, [*np.log(_START), 0.0])
    variance = 2.0 * fit.cost / (len(fit.fun) - 3)
    spread = np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)) * variance)
    k, c = np.exp(fit.x[:2])
    return Sinking(float(k), float(c), *(float(1.96 * v * s) for v, s in zip((k, c), spread, strict=False)))


@dataclass(frozen=True)
class _Run:
    """One recording: the force while the foot is pressed (N,), its depth by the encoders, rows that count."""

    force: np.ndarray
    depth: np.ndarray
    used: np.ndarray
    period: float

    @staticmethod
    def of(leg: Model, r: Recording, noise: float) -> _Run:
        force = r.extra["ground_force"][:, 2]
        pressed = force > _TOUCHES * noise
        lands = pressed & ~np.concatenate([[True], pressed[:-1]])
        used = pressed & ~lands  # the foot landed somewhere between this row and the one before
        position = r.position @ r.to_actuator(leg.transmission).T
        depth = Feet.along(compile_plant(leg, r.period, grounded=True), position, every=1).depth[:, 0]
        return _Run(np.where(pressed, force, 0.0), depth, used, r.period)

    def sunk(self, stiffness: float, damping: float) -> np.ndarray:
        """Depth (N,) [m] that the force makes: k d + c d' = force, linear from row to row."""
        late = damping / (stiffness * self.period)
        stays = np.exp(-1.0 / late)
        gains = 1.0 - late * (1.0 - stays), late * (1.0 - stays) - stays
        out = np.zeros(len(self.force))
        for start, end in _spans(self.force > 0.0):
            before = self.force[start - 1 : end - 1] if start else np.r_[0.0, self.force[: end - 1]]
            pushed = (gains[0] * self.force[start:end] + gains[1] * before) / stiffness
            first = stays * self.force[0] / stiffness if start == 0 else 0.0  # it stood there before
            out[start:end] = lfilter([1.0], [1.0, -stays], pushed, zi=[first])[0]
        return out


def _spans(on: np.ndarray) -> list[tuple[int, int]]:
    """First row, and row after the last, of every stretch that is on."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], on.astype(int), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
