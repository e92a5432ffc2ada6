"""Play between motor and link: worn teeth, keys, couplings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.optimize import minimize

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, Trace
from .chain import Build
from .flexible import can_split, frequencies, link_inertia, split, stiffest, transmitted
from .lacking import lacking
from .motion import Motion
from .response import Response

_RATE = 120.0  # rad/s: how fast the state follows the torque that passed
_MEAN = 4  # rows
_SETTLING = 25  # means
_BLOWN_UP = 1e300  # left by what cannot be followed at all; infinities have no differences
_SIMPLEX = np.array([[0.0, 0.0], [0.4, 0.0], [0.0, 0.2]])  # of logarithms


class Backlash(Effect):
    """torque on the link = k dead(r - q), zero for |r - q| < gap/2; the motor's angle r is logged."""

    name = "backlash"
    parameters = (
        Parameter("gap", "rad", about="all the play, from one flank to the other"),
        Parameter("stiffness", "N*m/rad", lower=1e-3, about="of either flank"),
    )
    nonlinear = ("gap", "stiffness")
    by_runs = True
    splits = True
    wanders = True
    door = Door.MECHANISM
    tier = 1
    contains = ("joint_compliance",)
    locations = ("actuator", "joint")
    needs_the_past = True
    trace = Trace.ODD
    source = "Nordin and Gutman, Controlling mechanical systems with backlash, Automatica 38(10), 2002"
    shows = "torque residual in bursts where the transmitted torque changes sign; small limit cycles"
    reveal = "slow reversals with little load on the axis, and a sweep of small amplitude"
    mujoco = "native: a joint for the motor, and a tendon to the links whose spring has a dead band"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Where a rotor can be taken off its link, once."""
        return can_split(model, key)

    def guesses(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[tuple[Mapping[str, float], float]]:
        """The gap that foresees best what passes through it: a grid, then downhill from its best."""
        assert place is not None
        inertia, _ = link_inertia(motions[0], place.index)
        way = max(float(np.ptp(m.position[:, place.index])) for m in motions) + 1e-9
        pieces = [_passage(m, model, place.index) for m in motions]
        rates = frequencies(motions, 10.0, 100.0, 9)
        gaps, stiffnesses = way * np.geomspace(2e-4, 0.1, 10), inertia * rates**2
        grid = np.stack(np.meshgrid(gaps, stiffnesses, indexing="ij"), axis=-1).reshape(-1, 2)
        start = grid[int(np.argmin(_left(pieces, inertia, grid)))]
        best = minimize(
            lambda x: float(_left(pieces, inertia, np.exp(x)[None])[0]),
            np.log(start),
            method="Nelder-Mead",
            options={
                "initial_simplex": np.log(start) + _SIMPLEX,
                "xatol": 1e-3,
                "fatol": np.inf,
                "maxfev": 80,
            },
        )
        found, least = np.exp(best.x), float(best.fun)
        if found[0] < 1e-4 * way:
            return []  # a spring, which is another effect
        rigid = _left(pieces, inertia, np.array([[0.0, stiffest(model, place)]]))
        stiffness = min(float(found[1]), stiffest(model, place))
        return [({"gap": float(found[0]), "stiffness": stiffness}, least / max(float(rigid[0]), 1e-300))]

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """The guesses."""
        return [shape for shape, _ in self.guesses(motions, model, place)]

    def shape_bounds(self, model: Model, place: Placement | None) -> dict[str, tuple[float, float]]:
        """Up to what is as good as rigid."""
        return {"gap": (0.0, 1.0), "stiffness": (1e-3, stiffest(model, place))}

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """No free coefficient: what the links do not feel of the motor's motion while they cross the gap."""
        assert place is not None
        inertia, column = link_inertia(motion, place.index)
        passage, error = _passage(motion, model, place.index), np.empty(len(motion.position))
        gap, stiffness = shape["gap"], shape["stiffness"]
        _observe(passage.load, passage.passed, motion.step, inertia, gap, stiffness, _RATE, error)
        # foreseen is what passed less the error; what rigid links would take beyond that, the motor need not
        share = (passage.load - passage.passed + error) / inertia
        return Response(np.zeros((0, *motion.position.shape)), offset=share[:, None] * column)

    def blur(
        self, values: Mapping[str, float], position_noise: float, torque_noise: float
    ) -> dict[str, float]:
        """How well the torque tells them: only motors are seen, and some links at a pin are in front."""
        return {"gap": values["gap"] / 12.0, "stiffness": values["stiffness"] / 25.0}

    def least(self, shape: Mapping[str, float]) -> np.ndarray:
        """Less makes a difference to when a flank is met, not to where."""
        return np.array([1e-5, 1e-3])

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """A joint for the motor and a tendon with a dead band to the links."""
        assert place is not None
        split(build, model, place, values["stiffness"], 0.0, values["gap"])


@dataclass(frozen=True)
class _Passage:
    """What passes through a gap along one motion: (N,) by rigid links, and as rotor and motor torque say."""

    step: float
    load: np.ndarray
    passed: np.ndarray


def _passage(motion: Motion, model: Model, index: int) -> _Passage:
    load = transmitted(motion, model, index)
    return _Passage(motion.step, load, load - lacking(motion, model)[:, index])


def _left(pieces: Sequence[_Passage], inertia: float, values: np.ndarray) -> np.ndarray:
    """Squared torque (C,) that C gaps and stiffnesses, (C, 2), leave unforeseen."""
    total = np.zeros(len(values))
    for k, (gap, stiffness) in enumerate(values.tolist()):
        for p in pieces:
            error = np.empty_like(p.load)
            _observe(p.load, p.passed, p.step, inertia, gap, stiffness, _RATE, error)
            with np.errstate(over="ignore", invalid="ignore"):
                total[k] += float(np.nan_to_num(np.sum(_means(error) ** 2), nan=_BLOWN_UP, posinf=_BLOWN_UP))
    return total


def _means(values: np.ndarray) -> np.ndarray:
    """Means over `_MEAN` rows of (N,), the settling left out: acceleration is noisy from row to row."""
    count = len(values) // _MEAN
    return values[: count * _MEAN].reshape(count, _MEAN).mean(axis=1)[_SETTLING:]


@njit(cache=True, nogil=True)
def _observe(load, passed, step, inertia, gap, stiffness, bandwidth, error):  # pyright: ignore
    """Follow the wind d between motor and links: inertia d'' = load - k dead(d), the motor's motion given.

    A path across a gap cannot be followed for long, so the state is drawn to where the torque that `passed`
    says that it is. Semi-implicit Euler, in steps that follow the contact; `error` (N,) is `passed` less the
    torque that was foreseen.
    """
    many = int(np.ceil(step * np.sqrt(stiffness / inertia) / 0.3))
    h, half = step / many, 0.5 * gap
    wind, rate = np.sign(passed[0]) * half + passed[0] / stiffness, 0.0
    for row in range(len(load)):
        into = 0.0 if abs(wind) <= half else wind - np.sign(wind) * half
        away = passed[row] - stiffness * into
        error[row] = away
        wind += 2.0 * bandwidth * step * away / stiffness
        rate += bandwidth**2 * step * away / stiffness
        for _ in range(many):
            into = 0.0 if abs(wind) <= half else wind - np.sign(wind) * half
            rate += h / inertia * (load[row] - stiffness * into)
            wind += h * rate
