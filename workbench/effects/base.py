"""What a physical effect is: parameters, a door, an equation, the same physics in MuJoCo."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum, auto
from typing import ClassVar, Literal

import numpy as np

from workbench.core import EffectKey
from workbench.models import BodyNumbers, JointNumber, Model, Placement, joint_kinds

from .chain import Build
from .motion import Motion
from .response import Response

INF = float("inf")


class Door(IntEnum):
    """Where an effect enters, in the order in which the torque chain applies the doors."""

    COMMAND = 0  # between torque_command and torque_measured
    MOTOR = 1  # after torque_measured: gain, bias
    FRICTION = 2  # opposes motion at an axis
    MECHANISM = 3  # inertia, gravity, springs
    SENSOR = 4  # what the log and the controller read of the motion
    CONTROLLER = 5  # what the loop makes of it


class Trace(Enum):
    """What an effect leaves in a measured frequency response over the model's own."""

    DELAY = auto()  # a phase that falls in proportion to frequency
    GAIN = auto()  # the same factor at all frequencies
    RESONANCE = auto()  # an anti-resonance and a resonance
    ODD = auto()  # distortion at odd lines, as of what changes sign with the motion
    EVEN = auto()  # distortion at even lines, as of what does not


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
    "1/(N*m)^2": "1/N^2",
    "1/rev": "rad/m",
}


class Effect(ABC):
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
        twins_by_command: effects that no log tells apart in which no torque was measured behind the drives.
        nonlinear: parameters that do not enter the torque linearly.
        dry: whether it sticks, so that the model's sliding speed matters.
        basic: whether it is one of the groups to start from: inertia, viscous, Coulomb.
        by_runs: whether a fit has to take its derivatives from simulations, since no column is exact near
            parameters that do something.
        splits: whether it gives the tree new joints, and so has to be installed before anything sits on it.
        on_links: whether it acts on links, which a spring or a gap may hold away from the motors.
        depends_on: quantities of its axis (``position``, ``speed``, ``acceleration``, ``load``) that decide
            its torque; empty where it is no torque on one axis, or of none of them alone.
        of_ground: whether it is one of a contact, which only recordings on the ground show.
        moves_feet: whether it puts a foot elsewhere at the same reading of the encoders.
        diverges: whether runs of nearly the same machine part, so that a fit of runs can add nothing to what
            the torque says.
        needs_the_past: whether it has a state that no sensor shows, or shifts the log in time, so that no run
            can begin with it in the middle of a recording.
        of_a_make: whether it comes with the make of a joint or its drive, so that all axes may have it alike;
            springs, offsets and ripples come with the assembly of each.
        adds_up: whether what a model states of it and what is found of it are one effect, of their sum.
        trace: what it leaves in a frequency response; None where that says nothing of it. On the input's
            side, or of a sensor on the output's.
        axes: ``"each"`` (acts on one axis), ``"all"`` (axis null).
        needs: what a model must have for it to apply, in words.
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
    twins_by_command: ClassVar[tuple[str, ...]] = ()
    nonlinear: ClassVar[tuple[str, ...]] = ()
    dry: ClassVar[bool] = False
    basic: ClassVar[bool] = False
    by_runs: ClassVar[bool] = False
    splits: ClassVar[bool] = False
    on_links: ClassVar[bool] = False
    depends_on: ClassVar[tuple[str, ...]] = ()
    of_ground: ClassVar[bool] = False
    moves_feet: ClassVar[bool] = False
    diverges: ClassVar[bool] = False
    needs_the_past: ClassVar[bool] = False
    of_a_make: ClassVar[bool] = False
    adds_up: ClassVar[bool] = False
    trace: ClassVar[Trace | None] = None
    axes: ClassVar[Literal["each", "all"]] = "each"
    needs: ClassVar[str] = "to be there once at most"
    locations: ClassVar[tuple[Literal["actuator", "joint"], ...]] = ("actuator",)
    source: ClassVar[str]
    shows: ClassVar[str]
    reveal: ClassVar[str]
    mujoco: ClassVar[str]

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Whether it can be added to this model in this place (and is not there already)."""
        del key
        return model.size > 0

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """Values to try for the parameters that do not enter linearly; one empty choice if all do."""
        del motions, model, place
        return ({},)

    def guesses(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[tuple[Mapping[str, float], float]]:
        """The same, best first, each with the share of the torque lacking along the motions that it leaves.

        For effects that `splits`: the torque alone says much of them, and closed loops are dear to simulate.
        """
        return [(shape, 1.0) for shape in self.shapes(motions, model, place)]

    def stated(self, model: Model, shape: Mapping[str, float]) -> Model:
        """The model with what a shape says beside the effect's parameters; unchanged if nothing."""
        del shape
        return model

    def stated_words(self, model: Model) -> str:
        """What the model states of this effect beside its parameters, in words; nothing to say: empty."""
        del model
        return ""

    def shape_bounds(self, model: Model, place: Placement | None) -> dict[str, tuple[float, float]]:
        """Physical bounds of the values in a shape."""
        del model, place
        return {p.name: (p.lower, p.upper) for p in self.parameters if p.name in self.nonlinear}

    def least(self, shape: Mapping[str, float]) -> np.ndarray:
        """Smallest changes (k + nonlinear,) of the unknowns that simulations show, if `by_runs`."""
        return np.full(len(self.parameters), 1e-9)

    def identifiable(
        self, motions: Sequence[Motion], place: Placement | None, values: Mapping[str, float]
    ) -> bool:
        """Whether motions go far enough to tell it, with these values, from any other smooth curve."""
        del motions, place, values
        return True

    def differs(
        self, motions: Sequence[Motion], place: Placement | None, values: Mapping[str, float]
    ) -> bool:
        """Whether with these values it is another machine than its special cases, and no refinement of one.

        Where it explains the same data as well, it is then named beside the special case.
        """
        del motions, place, values
        return False

    def blur(
        self, values: Mapping[str, float], position_noise: float, torque_noise: float
    ) -> dict[str, float]:
        """How far noise of the motion [rad or m] and the torque [N m or N] may shift parameters.

        A limit cuts the peaks of noise off but leaves its troughs, and a hysteresis remembers the noise, so
        that runs with noise are on average not the run without, which is what a fit simulates.
        """
        del values, position_noise, torque_noise
        return {}

    def sits(self, key: EffectKey, model: Model, place: Placement) -> bool:
        """Whether a key names this effect in this place."""
        where = key.axis, key.location
        return key.effect == self.name and where == (model.axes[place.index], place.location)

    def model_value(self, model: Model, place: Placement | None) -> float | None:
        """What a model has of the one number that this corrects; None where it corrects none."""
        del model, place
        return None

    def in_file(
        self, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> JointNumber | BodyNumbers | None:
        """Which number of the model's MJCF or URDF holds this effect; None where none does."""
        del model, place, values

    def reach(self, shape: Mapping[str, float]) -> dict[str, float]:
        """How far one step of a fit may move the values of a shape: half of themselves."""
        return {name: 0.5 * abs(value) + 1e-5 for name, value in shape.items()}

    @abstractmethod
    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """The effect's torque along a motion, given the nonlinear parameters in `shape`."""

    def foretells(
        self,
        motions: Sequence[Motion],
        model: Model,
        place: Placement | None,
        shape: Mapping[str, float],
    ) -> bool:
        """Whether its response says something by itself, where it asks measured torque for its state."""
        del motions, model, place, shape
        return True

    def free_responses(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> np.ndarray:
        """What states that no sensor shows add to the response, by where they begin: (N, n, states).

        One column for each state that begins at one; none where the response knows its beginning.
        """
        del model, place, shape
        return np.zeros((*motion.position.shape, 0))

    def before(self, motion: Motion, place: Placement | None, values: Mapping[str, float]) -> Motion:
        """The motion as the chain saw it before this effect was installed with these values."""
        del place, values
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

    @abstractmethod
    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Put the effect into the MuJoCo spec and torque chain of `build`."""

    def free(self, model: Model) -> int:
        """Number of parameters that the data have to determine in this model."""
        del model
        return len(self.parameters)


def is_rotary(model: Model, axis: str) -> bool:
    """Whether an axis turns, by the joint that its drive moves first."""
    row = np.abs(model.transmission[model.axes.index(axis)])
    return joint_kinds(model)[int(row.argmax())] == "hinge"
