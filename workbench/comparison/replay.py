"""How recordings are replayed on models: round the loop that made them, or along the measured motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar, Protocol

import numpy as np

from workbench.core import InputError, Recording
from workbench.effects import Motion, Plant
from workbench.models import Model
from workbench.simulation import Disturbance, prepare, scored_torque

from .closed_loop import ClosedLoop, with_loops
from .drift import drifts
from .following import MeasuredMotion, followed
from .grounded import Grounded
from .noise import DRAWS, NoiseModel
from .simulated import Simulated
from .standing import on_ground
from .swings import Swings, is_free


class Replay(Protocol):
    """Recordings and a way to run any model on them."""

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """What is replayed, with loops as they are taken."""
        ...

    @property
    def noise(self) -> NoiseModel:
        """The sensors."""
        ...

    #: Whether contacts with the ground are replayed, so that derivatives take simulations.
    on_ground: ClassVar[bool]
    #: Whether a run is a simulation; along a measured motion it is a sum over rows.
    simulates: ClassVar[bool]

    def shows(self, effect: str) -> bool:
        """Whether it can tell anything of an effect."""
        ...

    def like(self, model: Model, recordings: Sequence[Recording]) -> Replay:
        """The same sensors and the same kind of replay for other recordings."""
        ...

    def only(self, chosen: Sequence[int]) -> Replay:
        """The same for some of the recordings."""
        ...

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """Noise-free runs of the `first` recordings (all), one list a model; NaN where it cannot be run."""
        ...

    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Runs of one model, without noise and with it."""
        ...

    def motion(self, plant: Plant, index: int, run: Recording) -> Motion:
        """The motion of one recording, given a model's run of it."""
        ...

    def loop(self, plant: Plant, index: int, motion: Motion) -> Any:
        """How small changes travel along a motion: what `propagate` takes."""
        ...

    def propagate(
        self, loops: Sequence[Any], disturbances: Sequence[Disturbance]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Response of position and compared torque, (N, n, C) each, per loop."""
        ...


def replay_of(model: Model, recordings: Sequence[Recording], noise: NoiseModel | None = None) -> Replay:
    """How these recordings can be held against models like this one.

    Where one is on the ground, all run in short windows; where one loop is unknown, or open and drifting,
    all are replayed along their measured motion: so that one score counts. What nothing drives runs swing by
    swing.

    Raises:
        InputError: a loop is unknown and no torque was recorded.
    """
    noise = noise or NoiseModel.of(recordings)
    if any(map(on_ground, recordings)):
        return Grounded(model, recordings, noise)
    if all(map(is_free, recordings)):
        return Swings(recordings, noise)
    if not any(needs_inverse(model, r) for r in recordings) and not drifts(model, recordings):
        known = with_loops(model, recordings)
        return ClosedLoop(known, noise.with_unlogged_rate([prepare(r, model) for r in known]))
    blind = next((r for r in recordings if scored_torque(r) is None), None)
    if blind is not None:
        raise InputError(
            "neither the loop nor a torque is known", file=blind.source, column="controller",
            remedy="describe the controller, or name the column of the torque",
        )  # fmt: skip
    return MeasuredMotion(followed([_with_stated(model, r) for r in recordings]), noise, model)


def needs_inverse(model: Model, recording: Recording) -> bool:
    """Whether a recording's loop is unknown, so that only inverse dynamics can be compared."""
    known = recording.controller.kind != "unknown"
    return not known and (model.controller.kind == "unknown" or recording.get("position_reference") is None)


def _with_stated(model: Model, recording: Recording) -> Recording:
    """With the model's loop where the recording states none and could be run in that: so it is known."""
    known = recording.controller.kind != "unknown" or needs_inverse(model, recording)
    return recording if known else replace(recording, controller=model.controller)
