"""The base class of physical effects: parameters, a stage, an equation, and the same physics in MuJoCo."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum, auto
from typing import ClassVar, Literal

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, joint_kinds

from .chain import Build
from .corrected import AtJoint, OfBody
from .motion import Motion
from .parameter import Parameters, Place, Values
from .response import Response


class SignalStage(IntEnum):
    """Where an effect enters, in the order in which the torque chain applies the stages."""

    COMMAND = 0  # between torque_command and torque_measured
    MOTOR = 1  # after torque_measured: gain, bias
    FRICTION = 2  # opposes motion at an axis
    MECHANISM = 3  # inertia, gravity, springs
    SENSOR = 4  # what the log and the controller read of the motion
    CONTROLLER = 5  # what the loop makes of it


class FrfSignature(Enum):
    """The change that an effect makes to a measured frequency response, relative to the model's own."""

    DELAY = auto()  # a phase that falls in proportion to frequency
    GAIN = auto()  # the same factor at all frequencies
    RESONANCE = auto()  # an anti-resonance and a resonance
    ODD = auto()  # distortion at odd lines, as of what changes sign with the motion
    EVEN = auto()  # distortion at even lines, as of what does not


@dataclass(frozen=True)
class Words:
    """The texts that describe an effect to the user.

    Attributes:
        source: where the equation comes from.
        shows: against which quantity, in which band, odd or even: what evidence to look for.
        reveal: the experiment in which it stands out.
        mujoco: how it enters the MuJoCo model that policies train in.
        needs: what a model must have for it to apply.
    """

    source: str
    shows: str
    reveal: str
    mujoco: str
    needs: str = "to be present at most once"


@dataclass(frozen=True)
class Search:
    """Optional hints for the search, beside the equation.

    Attributes:
        contains: simpler effects in the same place that it has as special cases.
        differs: whether, along motions in a place and with some values, it is another machine than these,
            and no refinement of one: where it explains the data as well, it is then named beside them.
        twins: effects in the same place that, beside what this one contains, are a part of it under another
            name, so that no data can tell them apart.
        depends_on: quantities of its axis (``position``, ``speed``, ``acceleration``, ``load``) that decide
            its torque, those of friction without the speed; empty where it is no torque on one axis, or of
            none of them alone.
        frf_signature: what it leaves in a frequency response; None where that says nothing of it. On the
            input's side, or of a sensor on the output's.
        basic: whether it is one of the groups to start from: inertia, viscous, Coulomb.
        tier: 0 for simple effects, 1 for refinements that are tried after them; None for what `tier_of` says.
        shared_by_design: whether it comes with the make of a joint or its drive, so that all axes may have it
            alike, as friction and limits do; springs, offsets and ripples come with the assembly of each.
        repeats: whether, along motions in a place and with some values, it can be told from others of its
            kind there with values of their own, as harmonics of a ripple can over many periods; None: there
            is but one in a place.
        told_beside: whether, along motions in a place and with some values, it can be told beside a number of
            other effects there that depend on the same quantities; None: however many there are.
        hidden_state: whether it has a state that no sensor shows, or shifts the log in time, so that no run
            can begin with it in the middle of a recording.
    """

    contains: tuple[str, ...] = ()
    differs: Callable[[Sequence[Motion], Place, Values], bool] | None = None
    twins: tuple[str, ...] = ()
    depends_on: tuple[str, ...] = ()
    frf_signature: FrfSignature | None = None
    repeats: Callable[[Sequence[Motion], Place, Values, Sequence[Values]], bool] | None = None
    told_beside: Callable[[Sequence[Motion], Place, Values, int], bool] | None = None
    basic: bool = False
    tier: int | None = None
    shared_by_design: bool = False
    hidden_state: bool = False


#: Locations of what acts on the whole machine; its key has no axis.
WHOLE: tuple[Literal["actuator", "joint"], ...] = ()


class Effect(ABC):
    """A physical effect that can be added to a model; one subclass and one file each.

    Attributes:
        name: its name in files and JSON.
        parameters: what it is described by, in the order of the catalogue.
        stage: where it enters.
        locations: where on an axis it can sit, the usual place first; `WHOLE` where it acts on all axes.
        words: what a person is told of it.
        search: what a search goes by.
        corrects: the number of a model that it is more or less of.
    """

    name: ClassVar[str]
    parameters: ClassVar[Parameters] = Parameters()
    stage: ClassVar[SignalStage]
    locations: ClassVar[tuple[Literal["actuator", "joint"], ...]] = ("actuator",)
    words: ClassVar[Words]
    search: ClassVar[Search] = Search()
    corrects: ClassVar[AtJoint | OfBody | None] = None

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Return whether it can be added to this model in this place (and is not there already)."""
        del key
        return model.size > 0

    def site(self, model: Model) -> str | None:
        """Return the MJCF site of the effect in this model; None if it has none."""
        del model
        return None

    @abstractmethod
    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Return the effect's torque along a motion, given the nonlinear parameters in `shape`."""

    def before(self, motion: Motion, place: Place, values: Values) -> Motion:
        """Return the motion as the chain saw it before this effect was installed with these values."""
        del place, values
        return motion

    @abstractmethod
    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Put the effect into the MuJoCo spec and torque chain of `build`."""


def model_value(effect: Effect, model: Model, place: Place, values: Values) -> float | None:
    """The model's value of the number that an effect of these values corrects; None if it corrects none."""
    own = effect.corrects and effect.corrects.told_by(values).own
    return own(model, place) if own and place else None


def is_rotary(model: Model, axis: str) -> bool:
    """Return whether an axis turns, by the joint that its drive moves first."""
    row = np.abs(model.transmission[model.axes.index(axis)])
    return joint_kinds(model)[int(row.argmax())] == "hinge"
