"""Parameters of an effect: bounds, steps and first values of each, and the unknowns of a fit."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from itertools import product
from types import MappingProxyType
from typing import Any

import numpy as np

from workbench.models import Model

from .motion import Motion
from .setting import Setting

INF = float("inf")
Values = Mapping[str, float]
#: A `Placement`; None for what acts on the whole machine, which an effect knows of itself.
Place = Any


@dataclass(frozen=True)
class Unknown:
    """A number that a fit solves for, SI; normally a parameter, unless a `Chart` replaces it.

    Attributes:
        name: in a shape.
        lower, upper: its physical bounds.
        linear: whether the response is in proportion to it, less its neutral value.
        within: the bounds by a model and a place, where they are others than `lower` and `upper`.
        starts: first values to try of one that is not linear, along motions; None where `Parameters.starts`,
            or a spring's or a contact's `initial_values`, say them.
        reach: how far one step of a fit may move it, by all that are not linear; None for half of itself.
        least: the smallest change of it that simulations show; a number, or by the same.
    """

    name: str
    _: KW_ONLY
    lower: float = 0.0
    upper: float = INF
    linear: bool = True
    within: Callable[[Model, Place], tuple[float, float]] | None = None
    starts: Callable[[Sequence[Motion], Model, Place], Iterable[float]] | None = None
    reach: Callable[[Values], float] | None = None
    least: float | Callable[[Values], float] = 1e-9

    def bounds(self, model: Model, place: Place) -> tuple[float, float]:
        """Return lowest and highest value in a place of a model."""
        return self.within(model, place) if self.within else (self.lower, self.upper)


@dataclass(frozen=True)
class Parameter(Unknown):
    """A parameter of an effect, SI.

    Attributes:
        unit: for a rotary axis.
        neutral: the value without effect.
        example: a value to draw and to test it by, on the leg's knee.
        about: what it is, where its name does not say so.
        blur: how far noise of the motion [rad or m] and the torque [N m or N] may shift it, by all values. A
            limit cuts the peaks of noise off but leaves its troughs, and a hysteresis remembers the noise, so
            that runs with noise are on average not the run without, which is what a fit simulates.
        told: whether motions go far enough to tell it, with these values, from any other smooth curve.
        optional: whether it may be left out, and is neutral then.
        phase: whether it is the phase of a period, which is an angle on a linear axis too.
    """

    unit: str
    _: KW_ONLY
    neutral: float = 0.0
    example: float = 0.0
    about: str = ""
    blur: Callable[[Values, float, float], float] | None = None
    told: Callable[[Sequence[Motion], Place, Values], bool] | None = None
    optional: bool = False
    phase: bool = False

    def unit_on(self, axis_unit: str) -> str:
        """Return the unit on a rotary (``rad``) or linear (``m``) axis."""
        if axis_unit == "rad" or self.phase:
            return self.unit
        return _LINEAR_UNITS.get(self.unit, self.unit)


_LINEAR_UNITS = {
    "N*m": "N",
    "N*m*s/rad": "N*s/m",
    "N*m*s^2/rad^2": "N*s^2/m^2",
    "N*m/rad": "N/m",
    "rad": "m",
    "rad/s": "m/s",
    "kg*m^2": "kg",
    "1/(N*m)^2": "1/N^2",
    "1/rev": "rad/m",
}


@dataclass(frozen=True)
class Chart:
    """Unknowns that replace the parameters: in which the torque is linear, or that can be identified.

    `values`: parameters from linear coefficients (k,) and the rest; `solved`: the inverse. `special`: linear
    unknowns of another form, by the name that a shape of that form has.
    """

    unknowns: tuple[Unknown, ...]
    values: Callable[[np.ndarray, Values], dict[str, float]]
    solved: Callable[[Values], tuple[np.ndarray, dict[str, float]]]
    special: Mapping[str, tuple[Unknown, ...]] = field(default_factory=dict)


class Parameters(tuple[Parameter, ...]):
    """All parameters of an effect, and how a fit finds them.

    Attributes:
        chart: other unknowns than the parameters themselves.
        starts: first values of all unknowns that are not linear, where they go together.
        settles: what of the model is settled with them.
    """

    chart: Chart | None
    starts: Callable[[Sequence[Motion], Model, Place], Sequence[Values]] | None
    settles: tuple[Setting, ...]

    def __new__(
        cls,
        *parameters: Parameter,
        chart: Chart | None = None,
        starts: Callable[[Sequence[Motion], Model, Place], Sequence[Values]] | None = None,
        settles: tuple[Setting, ...] = (),
    ) -> Parameters:
        """The parameters, in the order of the catalogue."""
        self = super().__new__(cls, parameters)
        self.chart, self.starts, self.settles = chart, starts, settles
        return self

    @property
    def linear(self) -> tuple[Unknown, ...]:
        """Return unknowns in which the response is linear."""
        return self.linear_of({})

    def linear_of(self, shape: Values) -> tuple[Unknown, ...]:
        """Return the same for one shape, which may be that of another form."""
        special = self.chart.special if self.chart else {}
        own = next((unknowns for name, unknowns in special.items() if name in shape), self._unknowns)
        return tuple(u for u in own if u.linear)

    def count(self, values: Values) -> int:
        """Return the number of unknowns for some values: another form has others."""
        if any(p.optional and p.name in values for p in self):
            coefficients, _ = self.to_coefficients(values)
            return len(coefficients) + len(self.nonlinear)
        return len(values)

    def is_special(self, shape: Values) -> bool:
        """Return whether a shape is that of another form, with its own unknowns."""
        return self.chart is not None and any(name in shape for name in self.chart.special)

    def is_extended(self, shape: Values) -> bool:
        """Return whether a shape is that of a form with more unknowns than the usual one: a refinement."""
        return self.is_special(shape) and len(self.linear_of(shape)) > len(self.linear)

    @property
    def nonlinear(self) -> tuple[str, ...]:
        """Return names of the other unknowns, whose values are a shape."""
        return tuple(u.name for u in self._unknowns if not u.linear)

    @property
    def examples(self) -> dict[str, float]:
        """Return a value of each for pictures and tests."""
        return {p.name: p.example for p in self}

    def bounds(
        self, model: Model, place: Place, shape: Values = MappingProxyType({})
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return physical bounds of the linear coefficients, two arrays (k,)."""
        pairs = [u.bounds(model, place) for u in self.linear_of(shape)]
        neutral = [p.neutral for p in self if p.linear] if self.chart is None else [0.0] * len(pairs)
        low, high = ([pair[side] for pair in pairs] for side in (0, 1))
        return np.array(low) - np.array(neutral), np.array(high) - np.array(neutral)

    def shape_bounds(self, model: Model, place: Place) -> dict[str, tuple[float, float]]:
        """Return physical bounds of the values in a shape."""
        return {u.name: u.bounds(model, place) for u in self._shaped}

    def shapes(self, motions: Sequence[Motion], model: Model, place: Place) -> Sequence[Values]:
        """Return values to try for the nonlinear unknowns; one empty choice if there are none."""
        if self.starts is not None:
            return self.starts(motions, model, place)
        grids = [[float(x) for x in u.starts(motions, model, place)] for u in self._shaped if u.starts]
        return [dict(zip(self.nonlinear, some, strict=True)) for some in product(*grids)]

    def reach(self, shape: Values) -> dict[str, float]:
        """Return how far one step of a fit may change the values of a shape."""
        return {u.name: u.reach(shape) if u.reach else 0.5 * abs(shape[u.name]) + 1e-5 for u in self._shaped}

    def least(self, shape: Values) -> np.ndarray:
        """Return the smallest changes of the unknowns, linear ones first, that simulations show."""
        unknowns = (*self.linear_of(shape), *self._shaped)
        return np.array([u.least(shape) if callable(u.least) else u.least for u in unknowns])

    def to_values(self, coefficients: np.ndarray, shape: Values) -> dict[str, float]:
        """Return parameters from linear coefficients (k,), none if they are not free, and the shape."""
        if self.chart is not None:
            return self.chart.values(coefficients, shape)
        linear = [p for p in self if p.linear] if len(coefficients) else []
        pairs = zip(linear, map(float, coefficients), strict=True)
        return {**{p.name: p.neutral + x if p.neutral else x for p, x in pairs}, **shape}

    def to_coefficients(self, values: Values) -> tuple[np.ndarray, dict[str, float]]:
        """Return linear coefficients (k,) and shape from parameters: the inverse of `to_values`."""
        if self.chart is not None:
            return self.chart.solved(values)
        linear = [values[p.name] - p.neutral for p in self if p.linear]
        return np.array(linear, float), {name: values[name] for name in self.nonlinear}

    def stated(self, model: Model, shape: Values) -> Model:
        """Return the model with the settings of a shape besides the parameters; unchanged if there are
        none.
        """
        for setting in self.settles:
            if setting.in_shape in shape:
                model = setting.put(model, shape[setting.in_shape])
        return model

    def told(self, motions: Sequence[Motion], place: Place, values: Values) -> bool:
        """Return whether the motions are large enough to determine all of them."""
        return all(p.told(motions, place, values) for p in self if p.told)

    def blur(self, values: Values, position_noise: float, torque_noise: float) -> dict[str, float]:
        """Return how far noise may shift them."""
        return {p.name: p.blur(values, position_noise, torque_noise) for p in self if p.blur}

    @property
    def _unknowns(self) -> tuple[Unknown, ...]:
        return self if self.chart is None else self.chart.unknowns

    @property
    def _shaped(self) -> tuple[Unknown, ...]:
        return tuple(u for u in self._unknowns if not u.linear)


def rows(fewest: float, most: float, count: int) -> Callable[[Sequence[Motion], Model, Place], np.ndarray]:
    """Return first values of a delay or lag: so many, from `fewest` rows to `most` rows or milliseconds."""

    def starts(motions: Sequence[Motion], model: Model, place: Place) -> np.ndarray:
        del model, place
        step = motions[0].step
        return np.geomspace(fewest * step, max(most * step, 1e-3 * most), count)

    return starts
