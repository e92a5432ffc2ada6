"""Motion that nothing drives, replayed swing by swing from measured states.

Round no loop, an error of the start or of the period grows for as long as a run lasts: soon the phase of a
pendulum says nothing of its friction. Over one swing it does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from workbench.core import Recording
from workbench.effects import Motion, Plant, effect_named, kinds
from workbench.models import Model
from workbench.recordings import NoiseLevels, white_noise
from workbench.simulation import (
    Disturbance,
    Loop,
    Run,
    Track,
    linearise,
    motion_of,
    prepare,
    propagate,
    simulate,
    smooth_track,
)

from .noise import DRAWS, NoiseModel, noise_seeds
from .replay import Replay
from .simulated import Simulated
from .starts import local_state, shaken
from .swing_starts import swing_starts

_TORQUES = ("torque_command", "torque_measured", "torque_feedforward")
_NOISE = 1.5  # times the white noise of a torque, below which it is nothing else


def is_free(recording: Recording) -> bool:
    """Return whether nothing drives a recording: an open loop whose torque is zero except for noise."""
    if recording.controller.kind != "none":
        return False
    torques = [x for name in _TORQUES if (x := recording.get(name)) is not None]
    return bool(torques) and all(
        np.sqrt(np.mean(x[recording.valid] ** 2)) <= _NOISE * white_noise(x, recording.valid)
        for torque in torques
        for x in torque.T
    )


@dataclass(frozen=True)
class _Swinging:
    """One recording cut into swings.

    Attributes:
        recording: as it is compared; rows before the first swing are masked.
        starts: (W,), first rows of the swings.
        half: rows before and behind a start that say the state there.
    """

    recording: Recording
    starts: np.ndarray
    half: int

    @property
    def parts(self) -> list[slice]:
        """Rows of each swing."""
        ends = [*self.starts[1:], len(self.recording)]
        return [slice(int(a), int(b)) for a, b in zip(self.starts, ends, strict=True)]

    def pieces(self, seen: Recording, levels: NoiseLevels) -> list[tuple[Recording, np.ndarray]]:
        """The swings of a version of the recording, and their starts (2, n) in its coordinates."""
        q, w, _ = local_state(seen, levels, self.half)
        return [(self.recording.rows(p), np.stack([q[p.start], w[p.start]])) for p in self.parts]

    def joined(self, made: Sequence[Recording]) -> Recording:
        """Runs of all swings as one of the whole; rows before the first are as measured."""
        r, begin = self.recording, int(self.starts[0])
        signals = {
            name: np.concatenate([r.signals.get(name, x)[:begin], *(m.signals[name] for m in made)])
            for name, x in made[0].signals.items()
        }
        return replace(r, signals=signals, extra={}, derived=(), notes=(), source=None)


class FreeDecay(Replay[list[tuple[slice, Loop]]]):
    """A replay in which every model swings from measured states; position is scored."""

    driven: ClassVar[bool] = False
    each: ClassVar[tuple[str, ...]] = ("_swinging",)

    def __init__(self, recordings: Sequence[Recording], noise: NoiseModel) -> None:
        self.noise = noise
        self._swinging = tuple(_swinging(r, noise.levels) for r in recordings)
        self.recordings = tuple(s.recording for s in self._swinging)

    def shows(self, effect: str) -> bool:
        """Return whether it can show an effect: none with a state that no sensor shows at the start of a
        swing, and no nonlinear reading.
        """
        known = effect_named(effect)
        unseen = kinds.has_hidden_state(known) or kinds.bends_reading(known)
        return super().shows(effect) and not unseen

    def like(self, model: Model, recordings: Sequence[Recording]) -> FreeDecay:
        """Return the same replay with the same sensors for other recordings."""
        del model
        return FreeDecay(recordings, self.noise)

    def run(self, models: Sequence[Model], first: int | None = None) -> list[tuple[Recording, ...]]:
        """Return the runs of all models on all swings, simulated in one batch."""
        part = self._swinging[:first]
        return self._made(models, part, [s.recording for s in part], strict=False)

    def with_noise(self, model: Model, seed: int, draws: int = DRAWS) -> Simulated:
        """Return runs without and with sensor noise, both in the states at the starts and in the measured
        motion.

        Raises:
            SimulationError: a model that no body can be, or that is unstable.
        """
        (clean,) = self._made([model], self._swinging, self.recordings)
        quiet = [self._quiet(s) for s in self._swinging]
        (still,) = self._made([model], self._swinging, quiet)
        noisy = []
        for seeds in noise_seeds(len(clean), draws, seed):
            seen = [self._seen(q, s) for q, s in zip(quiet, seeds, strict=True)]
            (moved,) = self._made([model], self._swinging, seen)
            each = zip(clean, quiet, still, seen, moved, strict=True)
            noisy.append(tuple(shaken(*parts) for parts in each))
        return Simulated(self.recordings, clean, tuple(noisy), self.noise)

    def motion(self, plant: Plant, index: int, run: Recording) -> Motion:
        """Return the measured motion, whatever the run."""
        del run
        r, levels = self.recordings[index], self.noise.levels
        to_actuator = prepare(r, plant.model).to_actuator
        track = smooth_track(r, None, to_actuator, levels.position_std, levels.velocity_std)
        return motion_of(track, r, plant, to_actuator)

    def loop(self, plant: Plant, index: int, motion: Motion) -> list[tuple[slice, Loop]]:
        """Return each swing linearised about the motion, with its rows."""
        s = self._swinging[index]
        return [(p, _linearised(plant, s.recording.rows(p), motion, p)) for p in s.parts]

    def propagate(
        self, loops: Sequence[list[tuple[slice, Loop]]], disturbances: Sequence[Disturbance]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the responses to small disturbances along each swing from its start."""
        pairs = [(loop, _part(d, p)) for own, d in zip(loops, disturbances, strict=True) for p, loop in own]
        made = iter(propagate([loop for loop, _ in pairs], [d for _, d in pairs]))
        out = []
        for own, d in zip(loops, disturbances, strict=True):
            count, rows, n = d.torque.shape
            position, torque = np.zeros((2, rows, n, count))
            for p, _ in own:
                position[p], torque[p] = next(made)
            out.append((position, torque))
        return out

    def _made(
        self,
        models: Sequence[Model],
        swinging: Sequence[_Swinging],
        seen: Sequence[Recording],
        strict: bool = True,
    ) -> list[tuple[Recording, ...]]:
        """Runs of all models from what versions of the recordings say of the starts."""
        pieces = [s.pieces(r, self.noise.levels) for s, r in zip(swinging, seen, strict=True)]
        runs = [Run(m, r, start=start) for m in models for own in pieces for r, start in own]
        made = iter(simulate(runs, strict=strict))
        return [
            tuple(s.joined([next(made) for _ in own]) for s, own in zip(swinging, pieces, strict=True))
            for _ in models
        ]

    def _quiet(self, s: _Swinging) -> Recording:
        """The recording as smooth as its states were taken to be."""
        q, w, _ = local_state(s.recording, self.noise.levels, s.half)
        return s.recording.with_signals(position=q, velocity=w)

    def _seen(self, quiet: Recording, seed: int) -> Recording:
        """A smooth recording as noisy sensors would have shown it."""
        torque = np.zeros_like(quiet.position)
        q, w, _ = self.noise.draw(seed).logged(quiet.position, quiet.velocity, torque)
        return quiet.with_signals(position=q, velocity=w)


def _swinging(recording: Recording, levels: NoiseLevels) -> _Swinging:
    starts, half = swing_starts(recording, levels)
    valid = np.array(recording.valid)
    valid[: starts[0]] = False
    note = "No drive acts: each swing is simulated from its measured state"
    note += f", from {recording.time[starts[0]]:.3g} s on"
    return _Swinging(replace(recording, valid=valid, notes=(*recording.notes, note)), starts, half)


def _linearised(plant: Plant, piece: Recording, motion: Motion, part: slice) -> Loop:
    track = Track(motion.position[part], motion.velocity[part], motion.acceleration[part])
    return linearise(plant, prepare(piece, plant.model), track, motion.gain[part])


def _part(d: Disturbance, part: slice) -> Disturbance:
    """What disturbs some of the rows."""
    return Disturbance(
        d.torque[:, part],
        {k: x[part] for k, x in d.taps.items()},
        {k: x[part] for k, x in d.commands.items()},
        {k: x[:, part] for k, x in d.readings.items()},
    )
