"""What each unknown would change in the recorded signals, and the normal equations of that."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from operator import add

import numpy as np

from workbench.core import EffectKey, Recording
from workbench.effects import Motion, compile_plant, effect_named
from workbench.models import AppliedEffect, Model, Placement
from workbench.simulation import Loop, Track, linearise, motion_of, prepare, propagate, smooth_track

from .data import Data


@dataclass(frozen=True)
class Column:
    """One unknown along every recording: torque on the mechanism and change at the tap, (N, n) each."""

    torque: tuple[np.ndarray, ...]
    tap: tuple[np.ndarray | None, ...]


@dataclass(frozen=True)
class Scene:
    """A model on the recordings: motions that were made, loops linearised about them."""

    model: Model
    motions: tuple[Motion, ...]
    loops: tuple[Loop, ...]

    @staticmethod
    def of(model: Model, data: Data, simulated: Sequence[Recording], count: int) -> Scene:
        """The first `count` recordings of `data` with a model's runs of them."""
        plant = compile_plant(model)
        levels, motions, loops = data.noise.levels, [], []
        for recording, run in zip(data.recordings[:count], simulated[:count], strict=True):
            e = prepare(recording, model)
            usable = run if np.isfinite(run.position).all() else None
            track: Track = smooth_track(
                recording, usable, e.to_actuator, levels.position_std, levels.velocity_std
            )
            motions.append(motion_of(track, recording, plant, e.to_actuator))
            loops.append(linearise(plant, e, track))
        return Scene(model, tuple(motions), tuple(loops))

    def columns(self, key: EffectKey, shape: Mapping[str, float]) -> tuple[list[Column], Column | None]:
        """All linear columns of an effect and its fixed part, evaluating it once a recording."""
        place = Placement.of(self.model, key)
        responses = [effect_named(key.effect).response(m, self.model, place, shape) for m in self.motions]
        linear = [
            Column(tuple(r.columns[i] for r in responses), tuple(None for _ in responses))
            for i in range(len(responses[0].columns))
        ]
        if responses[0].offset is None:
            return linear, None
        fixed = Column(tuple(r.offset for r in responses), tuple(r.tap for r in responses))  # type: ignore[arg-type]
        return linear, fixed

    def total(self, applied: AppliedEffect, values: Mapping[str, float]) -> Column:
        """The torque of an effect with given parameter values."""
        effect = effect_named(applied.key.effect)
        coefficients, shape = effect.to_coefficients(values)
        linear, fixed = self.columns(applied.key, shape)
        return combine([*linear, *([fixed] if fixed else [])], [*coefficients, *([1.0] if fixed else [])])

    def derivatives(self, applied: AppliedEffect) -> list[Column]:
        """Derivative of an installed effect's torque by each coefficient, then each nonlinear parameter.

        The tap is left out: a held torque that is late by a fraction of a row shows the same rows.
        """
        effect = effect_named(applied.key.effect)
        scene = replace(self, motions=tuple(effect.before(m, applied.values) for m in self.motions))
        coefficients, shape = effect.to_coefficients(applied.values)
        out = scene.columns(applied.key, shape)[0]
        for name in effect.nonlinear:
            parameter = next(p for p in effect.parameters if p.name == name)
            step = max(0.05 * abs(shape[name]), 1e-12)
            if name == "time":
                step = 0.2 * scene.motions[0].step
            low = max(shape[name] - step, parameter.lower)
            high = min(shape[name] + step, parameter.upper)
            pair = [
                scene.total(applied, effect.to_parameters(coefficients, {**shape, name: value}))
                for value in (low, high)
            ]
            slope = combine(pair, [-1.0 / (high - low), 1.0 / (high - low)])
            out.append(Column(slope.torque, tuple(None for _ in slope.tap)))
        return out


def combine(columns: Sequence[Column], factors: Sequence[float]) -> Column:
    """Linear combination of columns."""
    count = len(columns[0].torque)
    torque, tap = [], []
    for i in range(count):
        torque.append(np.sum([f * c.torque[i] for c, f in zip(columns, factors, strict=True)], axis=0))
        taps = [f * t for c, f in zip(columns, factors, strict=True) if (t := c.tap[i]) is not None]
        tap.append(np.sum(taps, axis=0) if taps else None)
    return Column(tuple(torque), tuple(tap))


def respond(
    scenes: Sequence[Scene], columns: Sequence[Sequence[Column]], data: Data
) -> list[list[np.ndarray]]:
    """Send columns round the loops of their scenes; all scenes march together.

    Args:
        scenes: S of them.
        columns: per scene, the columns; padded to the same number inside.
        data: for the weights.

    Returns:
        Per scene and recording the weighted change of the scored signals, (N, 2, n, C).
    """
    width = max((len(c) for c in columns), default=0)
    if width == 0:
        return [
            [np.zeros((*m.position.shape[:1], 2, m.position.shape[1], 0)) for m in s.motions] for s in scenes
        ]
    loops, torques, taps = [], [], []
    for scene, own in zip(scenes, columns, strict=True):
        for i, motion in enumerate(scene.motions):
            torque = np.zeros((width, *motion.position.shape))
            tap = np.zeros_like(torque) if any(c.tap[i] is not None for c in own) else None
            for k, column in enumerate(own):
                torque[k] = column.torque[i]
                if tap is not None and column.tap[i] is not None:
                    tap[k] = column.tap[i]
            loops.append(scene.loops[i])
            torques.append(torque)
            taps.append(tap)
    flat = propagate(loops, torques, taps)
    out, position = [], 0
    for scene, own in zip(scenes, columns, strict=True):
        rows = []
        for i in range(len(scene.motions)):
            q, u = flat[position]
            position += 1
            stacked = np.stack([q, u], axis=1)[..., : len(own)] * data.weight[None, :, :, None]
            stacked[~data.recordings[i].valid] = 0.0
            rows.append(stacked)
        out.append(rows)
    return out


@dataclass(frozen=True)
class Normal:
    """Normal equations of one piece of data: gram (C, C), right side (C,), squared residual, samples."""

    gram: np.ndarray
    right: np.ndarray
    square: float
    samples: int

    def __add__(self, other: Normal) -> Normal:
        return Normal(
            self.gram + other.gram,
            self.right + other.right,
            self.square + other.square,
            self.samples + other.samples,
        )

    def __sub__(self, part: Normal) -> Normal:
        return Normal(
            self.gram - part.gram,
            self.right - part.right,
            self.square - part.square,
            self.samples - part.samples,
        )

    def pick(self, index: Sequence[int]) -> Normal:
        """Only these unknowns."""
        i = np.asarray(index, int)
        return Normal(self.gram[np.ix_(i, i)], self.right[i], self.square, self.samples)

    def after(self, solution: np.ndarray) -> float:
        """Squared residual when the unknowns take these values."""
        return float(self.square - 2.0 * self.right @ solution + solution @ self.gram @ solution)


def normal(response: np.ndarray, residual: np.ndarray) -> Normal:
    """Normal equations from weighted responses (N, 2, n, C) and weighted residuals (N, 2, n)."""
    x, y = response.reshape(residual.size, response.shape[-1]), residual.reshape(-1)
    return Normal(x.T @ x, x.T @ y, float(y @ y), len(residual))


def total(pieces: Sequence[Normal]) -> Normal:
    """Normal equations of all pieces together."""
    return reduce(add, pieces)
