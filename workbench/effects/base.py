"""What a physical effect is: parameters, a door, an equation, the same physics in MuJoCo."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import ClassVar, Literal

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .chain import Build
from .motion import Motion

INF = float("inf")


class Door(IntEnum):
    """Where an effect enters, in the order in which the torque chain applies the doors."""

    COMMAND = 0  # between torque_command and torque_measured
    MOTOR = 1  # after torque_measured: gain, bias
    FRICTION = 2  # opposes motion at an axis
    MECHANISM = 3  # inertia, gravity, springs


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect, SI.

    `unit` for a rotary axis; `lower`, `upper` its physical bounds; `neutral` the value without effect.
    """

    name: str
    unit: str
    lower: float = 0.0
    upper: float = INF
    neutral: float = 0.0
    about: str = ""

    def unit_on(self, axis_unit: str) -> str:
        """The unit on a rotary (``rad``) or linear (``m``) axis."""
        return self.unit if axis_unit == "rad" else _LINEAR_UNITS.get(self.unit, self.unit)


_LINEAR_UNITS = {
    "N*m": "N",
    "N*m*s/rad": "N*s/m",
    "N*m*s^2/rad^2": "N*s^2/m^2",
    "N*m/rad": "N/m",
    "rad": "m",
    "rad/s": "m/s",
    "kg*m^2": "kg",
}


@dataclass(frozen=True)
class Response:
    """An effect's torque along a motion, split into what is linear in unknown coefficients.

    Attributes:
        columns: torque on the mechanism per unit of each coefficient, shape (k, N, n), actuator
            coordinates; k may be 0.
        offset: torque that has no free coefficient, (N, n), or None.
        tap: change of `torque_measured` itself, (N, n), or None where the tap does not see it.
    """

    columns: np.ndarray
    offset: np.ndarray | None = None
    tap: np.ndarray | None = None


class Effect:
    """A physical effect that can be added to a model; one subclass and one file each.

    Subclasses set the class attributes and implement `response` and `install`.

    Attributes:
        name: its name in files and JSON.
        parameters: its parameters in the order of the catalogue.
        door: where it enters.
        tier: 0 for the basic physical groups, 1 for refinements that are tried after them.
        contains: simpler effects in the same place that it has as special cases.
        twins: effects in the same place that, beside what this one contains, are a part of it under
            another name, so that no data can tell them apart.
        nonlinear: parameters that do not enter the torque linearly.
        dry: whether it sticks, so that the model's sliding speed matters.
        basic: whether it is one of the groups to start from: inertia, viscous, Coulomb.
        axes: ``"each"`` (acts on one axis), ``"all"`` (axis null).
        locations: where on an axis it can sit.
        source: where the equation comes from.
        shows: against which quantity, in which band, odd or even: what evidence to look for.
        reveal: the experiment in which it stands out.
        mujoco: how it enters the MuJoCo model that policies train in.
    """

    name: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]] = ()
    door: ClassVar[Door]
    tier: ClassVar[int] = 0
    contains: ClassVar[tuple[str, ...]] = ()
    twins: ClassVar[tuple[str, ...]] = ()
    nonlinear: ClassVar[tuple[str, ...]] = ()
    dry: ClassVar[bool] = False
    basic: ClassVar[bool] = False
    axes: ClassVar[Literal["each", "all"]] = "each"
    locations: ClassVar[tuple[Literal["actuator", "joint"], ...]] = ("actuator",)
    source: ClassVar[str]
    shows: ClassVar[str]
    reveal: ClassVar[str]
    mujoco: ClassVar[str]

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Whether it can be added to this model in this place (and is not there already)."""
        del key
        return model.size > 0

    def shapes(self, motion: Motion, model: Model, place: Placement | None) -> Sequence[Mapping[str, float]]:
        """Values to try for the parameters that do not enter linearly; one empty choice if all do."""
        del motion, model, place
        return ({},)

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """The effect's torque along a motion, given the nonlinear parameters in `shape`."""
        raise NotImplementedError

    def before(self, motion: Motion, values: Mapping[str, float]) -> Motion:
        """The motion as the chain saw it before this effect was installed with these values."""
        del values
        return motion

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """Physical bounds of the linear coefficients, two arrays (k,)."""
        del model, place
        linear = [p for p in self.parameters if p.name not in self.nonlinear]
        return np.array([p.lower for p in linear]), np.array([p.upper for p in linear])

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """Parameters from linear coefficients (k,) and the nonlinear values."""
        linear = [p.name for p in self.parameters if p.name not in self.nonlinear]
        return {**dict(zip(linear, map(float, coefficients), strict=True)), **shape}

    def to_coefficients(self, values: Mapping[str, float]) -> tuple[np.ndarray, dict[str, float]]:
        """Linear coefficients (k,) and nonlinear values from parameters: the inverse of `to_parameters`."""
        linear = [values[p.name] for p in self.parameters if p.name not in self.nonlinear]
        return np.array(linear, float), {name: values[name] for name in self.nonlinear}

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Put the effect into the MuJoCo spec and torque chain of `build`."""
        raise NotImplementedError

    def free(self, model: Model) -> int:
        """Number of parameters that the data have to determine in this model."""
        del model
        return len(self.parameters)


def smooth_sign(speed: np.ndarray) -> np.ndarray:
    """Sign of a measured speed, softened where it is lost in noise (1 % of the rms speed)."""
    width = 0.01 * float(np.sqrt(np.mean(speed**2))) + 1e-12
    return np.tanh(speed / width)


def single(place: Placement, torque: np.ndarray, motion: Motion) -> np.ndarray:
    """Torque on one coordinate, (N,), as generalised torque in actuator coordinates, (N, n).

    By virtual work: tau_s = row^T torque, and tau_p = J^-T tau_s (paper, Eq. 4).
    """
    return torque[:, None] * (np.linalg.inv(motion.transmission).T @ place.row)[None, :]
