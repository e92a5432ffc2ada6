"""Recordings of mechanisms whose transmission changes with the posture: simulated in their loops, and
scored.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Never, NoReturn

import numpy as np

from workbench.core import InputError, Recording, SimulationError
from workbench.effects import Motion, Plant
from workbench.models import Model
from workbench.simulation import Disturbance, PosturePlant, run_posture

from .closed_loop import late_by, with_loops
from .noise import DRAWS, NoiseModel, noise_seeds
from .replay import Replay
from .simulated import Simulated


@dataclass(frozen=True)
class ByPosture(Replay[Never]):
    """A replay that simulates every model as the recordings were made; it serves comparison, not the search
    for effects.
    """

    recordings: tuple[Recording, ...]
    noise: NoiseModel

    @staticmethod
    def of(model: Model, recordings: Sequence[Recording], noise: NoiseModel) -> ByPosture:
        """Return the replay; recordings that do not state their loop take that of the model.

        Raises:
            InputError: neither knows one.
        """
        known = with_loops(model, recordings)
        for r in known:
            if r.controller.kind == "unknown":
                raise InputError(
                    "its loop is not known, and the transmission changes with the posture", file=r.source,
                    column="controller", remedy="describe the controller",
                )  # fmt: skip
        return ByPosture(known, noise)

    def like(self, model: Model, recordings: Sequence[Recording]) -> ByPosture:
        """Return the same replay for other recordings."""
        return ByPosture.of(model, recordings, self.noise)

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """Return the runs of every model on all recordings; NaN where a model cannot be simulated."""
        return [tuple(_run(PosturePlant(m), r) for r in self.recordings[:first]) for m in models]

    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Return runs of one model without and with sensor noise, which passes through the sampled loop.

        Raises:
            SimulationError: the model runs away in a recording's loop, or leaves its workspace.
        """
        plant, seeds = PosturePlant(model), noise_seeds(len(self.recordings), draws, seed)
        made = [
            run_posture(plant, r, [None, *(self.noise.draw(s[i]) for s in seeds)])
            for i, r in enumerate(self.recordings)
        ]
        late = tuple(run_posture(plant, r, [None], late_by(r))[0] for r in self.recordings)
        clean = tuple(runs[0] for runs in made)
        noisy = tuple(tuple(runs[d + 1] for runs in made) for d in range(draws))
        return Simulated(self.recordings, clean, noisy, self.noise, late)

    def motion(self, plant: Plant, index: int, run: Recording) -> Motion:
        """Not available for these mechanisms."""
        raise _no_search(plant.model)

    def loop(self, plant: Plant, index: int, motion: Motion) -> NoReturn:
        """Not available for these mechanisms."""
        raise _no_search(plant.model)

    def propagate(self, loops: Sequence[Never], disturbances: Sequence[Disturbance]) -> NoReturn:
        """Not available for these mechanisms."""
        raise SimulationError("effects are not looked for in mechanisms whose transmission changes")


def _run(plant: PosturePlant, recording: Recording) -> Recording:
    try:
        return run_posture(plant, recording, [None])[0]
    except SimulationError:
        return recording.with_signals(**{name: x * np.nan for name, x in recording.signals.items()})


def _no_search(model: Model) -> InputError:
    return InputError(
        f"the transmission of '{model.name}' changes with the posture, so no effect can be found in its loop",
        file=model.source, column="transmission.posture_dependent",
        remedy="use diagnose or improve: these search for effects in the torque",
    )  # fmt: skip
