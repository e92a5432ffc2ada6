"""Torque ripple that repeats with the angle: magnets and slots, teeth, a bearing's balls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from workbench.models import Model

from .base import Effect, Search, SignalStage, Words
from .chain import Build, TorqueTerm
from .law import law
from .motion import Motion
from .parameter import INF, Parameter, Parameters, Place, Unknown, Values
from .response import Response, single
from .wave import wave

_LEAST = 0.75  # periods within the motion: less is a bend, which any spring may have
_SEVERAL = 3.0  # periods within the motion, from which a sine beside others is told from a smooth curve
_TRIED = 6  # orders that go on to the linearised loop
_HARMONICS = 5  # of these, that are looked for one after the other
_SHOWN = 1e-3  # of what is lacking, that one more of these has to explain
_FINEST = 400  # of these, multiples of a quarter of a ripple over the whole arc
_BINS = 8 * _FINEST  # of the arc


def _told(motions: Sequence[Motion], place: Place, values: Values, beside: int = 0) -> bool:
    """Over most of a period, and as much again for each other law of position: each follows a bend more."""
    return _periods(motions, place, values) >= _LEAST * (1 + beside)


def _periods(motions: Sequence[Motion], place: Place, values: Values) -> float:
    rows = [m.along(place)[0] for m in motions]
    arc = max(float(r.max()) for r in rows) - min(float(r.min()) for r in rows)
    return values["order"] * arc / (2.0 * np.pi)


def _repeats(motions: Sequence[Motion], place: Place, values: Values, others: Sequence[Values]) -> bool:
    """Over several periods, as on a shorter way a sum of sines follows anything; a period from any other."""
    apart = [{"order": abs(values["order"] - other["order"])} for other in others]
    return _periods(motions, place, values) >= _SEVERAL and all(
        _periods(motions, place, between) >= 1.0 for between in apart
    )


def _orders(motions: Sequence[Motion], model: Model, place: Place) -> np.ndarray:
    """Orders that the missing torque shows most of, by least squares on the torque itself."""
    position = np.concatenate([m.along(place)[0] for m in motions])
    lacking = np.concatenate([((m.required(model) - m.torque) * m.gain)[:, place.index] for m in motions])
    shown = _Binned.of(position, lacking - lacking.mean())
    step = shown.step
    slow = 1.0 if motions[0].axis_units[place.index] == "rad" else 0.0
    first = max(round(4 * _LEAST), math.ceil(slow / step))
    orders = step * np.arange(first, _FINEST)
    if not len(orders):  # so many turns that a ripple per turn is finer than what is searched
        return orders
    gain = shown.explained_by_each()[first:]
    peaks = np.flatnonzero((gain >= np.roll(gain, 1)) & (gain >= np.roll(gain, -1)))
    best = orders[peaks[np.argsort(-gain[peaks])[:_TRIED]]]
    finer = _one_after_the_other(orders, gain, shown)
    return np.array([*finer, *(o for o in best if min(abs(o - f) for f in finer) > step)])


def _one_after_the_other(orders: np.ndarray, gain: np.ndarray, shown: _Binned) -> list[float]:
    """Orders, to a part of a step, that explain most of what those before them leave; `gain`: of all.

    A strong one hides weak ones beside it, above all where it is a little off: so each is refined beside all.
    """
    found, step = list[float](), shown.step
    while not found or (len(found) < _HARMONICS and gain.max() > _SHOWN * shown.square):
        found.append(float(orders[gain.argmax()]))
        for k in reversed(range(len(found))):
            others = shown.waves([*found[:k], *found[k + 1 :]])
            found[k] = float(
                minimize_scalar(
                    lambda order, others=others: -shown.explained(order, others),
                    bounds=(max(found[k] - step, orders[0]), found[k] + step),
                    method="bounded",
                    options={"xatol": 1e-3 * step},
                ).x
            )
        if len(found) < _HARMONICS:
            gain = shown.without(found).explained_by_each()[-len(orders) :]
    return found


@dataclass(frozen=True)
class _Binned:
    """Values summed in even bins of the position: middle of the first, width, rows, and sums of values."""

    start: float
    width: float
    count: np.ndarray
    total: np.ndarray

    @staticmethod
    def of(position: np.ndarray, values: np.ndarray) -> _Binned:
        """The sums of a histogram are those of the rows, as long as its bins are finer than a ripple."""
        low, width = float(position.min()), (float(np.ptp(position)) + 1e-9) / _BINS
        index = np.clip(((position - low) / width).astype(int), 0, _BINS - 1)
        return _Binned(
            low + 0.5 * width,
            width,
            np.bincount(index, minlength=_BINS).astype(float),
            np.bincount(index, weights=values, minlength=_BINS),
        )

    @property
    def step(self) -> float:
        """Orders of a quarter of a ripple over the whole arc."""
        return 0.5 * np.pi / (_BINS * self.width)

    @property
    def square(self) -> float:
        """Squared sum of the means of the bins."""
        return float(np.sum(self.total**2 / np.maximum(self.count, 1.0)))

    def waves(self, orders: Sequence[float]) -> np.ndarray:
        """A mean, and sines and cosines of some orders, a row each."""
        angle = self.start + self.width * np.arange(_BINS)
        rows = [f(order * angle) for order in orders for f in (np.sin, np.cos)]
        return np.stack([np.ones(_BINS), *rows])

    def explained_by_each(self) -> np.ndarray:
        """Squared sum that each of the first `_FINEST` multiples of `step` explains by itself beside a mean.

        Their phases go in even steps along the bins, so that one transform has the sums of all.
        """
        total = np.fft.rfft(self.total, 4 * _BINS)[:_FINEST]
        every = np.fft.rfft(self.count, 4 * _BINS)[: 2 * _FINEST]
        rows, once, twice = every[0].real, every[:_FINEST], every[::2]
        gram = np.empty((_FINEST, 3, 3))
        gram[:, 0, 0] = rows
        gram[:, 0, 1] = gram[:, 1, 0] = -once.imag
        gram[:, 0, 2] = gram[:, 2, 0] = once.real
        gram[:, 1, 1], gram[:, 2, 2] = 0.5 * (rows - twice.real), 0.5 * (rows + twice.real)
        gram[:, 1, 2] = gram[:, 2, 1] = -0.5 * twice.imag
        right = np.stack([np.broadcast_to(self.total.sum(), _FINEST), -total.imag, total.real], axis=1)
        return np.einsum("ki,kij,kj->k", right, np.linalg.pinv(gram, rcond=1e-9, hermitian=True), right)

    def explained(self, order: float, others: np.ndarray) -> float:
        """Squared sum that an order explains together with other `waves`."""
        _, right, weights = self._fit(np.concatenate([others, self.waves([order])[1:]]))
        return float(right @ weights)

    def without(self, orders: Sequence[float]) -> _Binned:
        """The values less what orders explain of them."""
        basis, _, weights = self._fit(self.waves(orders))
        return replace(self, total=self.total - self.count * (weights @ basis))

    def _fit(self, basis: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows of a basis; right side and coefficients of their fit."""
        right = basis @ self.total
        return basis, right, np.linalg.lstsq((basis * self.count) @ basis.T, right, rcond=1e-9)[0]


#: One step of a fit is less than what brings ripples out of step within a radian.
_ORDER = Unknown("order", lower=0.1, linear=False, starts=_orders, reach=lambda shape: 0.3)


class Cogging(Effect):
    """torque = a sin(order * q + phase), a the parameter `torque`."""

    name = "cogging"
    parameters = Parameters(
        Parameter("torque", "N*m", example=0.2),
        Parameter(
            "order",
            "1/rev",
            lower=0.1,
            about="periods per turn; a list for several, with as many torques and phases",
            example=24.0,
            linear=False,
            told=_told,
        ),
        Parameter("phase", "rad", lower=-np.pi, upper=np.pi, example=0.6, phase=True),
        chart=wave("torque", "phase", INF, _ORDER),
    )
    stage = SignalStage.MOTOR
    words = Words(
        source="Jahns and Soong, Pulsating torque minimization techniques, IEEE Trans. Ind. "
        "Electron. 43(2), 1996",
        shows="torque residual follows a sine of the angle, with the same size at every speed",
        reveal="a slow steady sweep over the whole range, in both directions",
        mujoco="torque function of the position",
    )
    search = Search(depends_on=("position",), repeats=_repeats, told_beside=_told)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Two columns, sine and cosine; their coefficients are a cos p and a sin p."""
        angle = shape["order"] * motion.along(place)[0]
        return Response(np.stack([single(place, row, motion) for row in (np.sin(angle), np.cos(angle))]))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A torque of the position, on the drive."""
        parameters = values["torque"], values["order"], values["phase"]
        build.chain.torques.append(TorqueTerm(place.tendon, ripple, parameters))


@law
def ripple(position: float, speed: float, p: Sequence[float]) -> float:
    """Return the torque at a position; amplitude, order and phase."""
    return p[0] * math.sin(p[1] * position + p[2])
