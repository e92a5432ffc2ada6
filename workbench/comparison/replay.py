"""What every way to replay recordings on models can do, and what each kind says to a search.

There are four: in the loops that made them (`ClosedLoop`), along the measured motion
(`InverseDynamicsReplay`), swing by swing (`FreeDecay`), and in short windows on the ground
(`ContactWindows`). `replay_of` chooses one.
"""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, Generic, Self, TypeVar

import numpy as np

from workbench.core import Recording
from workbench.effects import Effect, Motion, OnGround, Plant, effect_named
from workbench.models import Model
from workbench.simulation import Disturbance

from .noise import DRAWS, NoiseModel
from .simulated import Simulated

#: How small changes travel along one recording, as a kind of replay has it.
Travel = TypeVar("Travel")


class Replay(ABC, Generic[Travel]):
    """Recordings, and a way to replay any model on them."""

    recordings: tuple[Recording, ...]  #: what is replayed, with loops as they are taken
    noise: NoiseModel  #: the sensors

    #: Whether a run is a simulation; along a measured motion it is a sum over rows, which costs nothing.
    simulates: ClassVar[bool] = True
    #: Whether drives push; what nothing drives shows no motors, and its torque no more than that it is nil.
    driven: ClassVar[bool] = True
    #: Whether nothing but the machine decides the torque along a motion. Where the ground's force is part of
    #: it, no law along the motion, no response of a loop, no sign of an axis can be asked by itself.
    machine_alone: ClassVar[bool] = True
    #: Whether runs change smoothly with parameters and starts. Where contacts make and break, derivatives
    #: take runs, right simulations differ more, and names stand near the noise only.
    smooth: ClassVar[bool] = True
    #: Attributes of which there is one for each recording, beside `recordings`.
    each: ClassVar[tuple[str, ...]] = ()

    def shows(self, effect: str) -> bool:
        """Return whether the replay can show an effect; contacts are shown only on the ground."""
        return not isinstance(effect_named(effect), OnGround)

    def needs_runs(self, effect: Effect) -> bool:
        """Return whether an effect is no torque along a motion, so that it has to be simulated for
        screening.
        """
        del effect
        return False

    @abstractmethod
    def like(self, model: Model, recordings: Sequence[Recording]) -> Replay:
        """Return the same kind of replay with the same sensors for other recordings."""

    def only(self, chosen: Sequence[int]) -> Self:
        """Return the same replay for some of the recordings."""
        part = copy.copy(self)
        for name in ("recordings", *self.each):
            object.__setattr__(part, name, tuple(getattr(self, name)[i] for i in chosen))
        return part

    @abstractmethod
    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """Return noise-free runs of the `first` recordings (default: all), one list per model; NaN where a
        model cannot be simulated.
        """

    @abstractmethod
    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Return runs of one model, without noise and with it."""

    @abstractmethod
    def motion(self, plant: Plant, index: int, run: Recording) -> Motion:
        """Return the motion of one recording, given a run of a model on it."""

    @abstractmethod
    def loop(self, plant: Plant, index: int, motion: Motion) -> Travel:
        """Return how small changes travel along a motion: the input of `propagate`."""

    @abstractmethod
    def propagate(
        self, loops: Sequence[Travel], disturbances: Sequence[Disturbance]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the responses of position and compared torque, (N, n, C) each, per loop."""

    def start_responses(self, model: Model, index: int) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the first rows of a recording's windows (W,), and what a change of the state measured at
        each start does in its window to position and compared torque, (N, 2, n, k).

        None where runs do not start from measured states.
        """
        del model, index
        return None
