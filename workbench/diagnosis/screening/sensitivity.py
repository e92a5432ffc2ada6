"""Sensitivity columns: how each unknown changes torques, commands and readings along the motions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from workbench.core import EffectKey, Recording
from workbench.effects import Compliance, Effect, Motion, Plant, compile_plant, effect_named, kinds
from workbench.models import AppliedEffect, Model, Placement, own_friction
from workbench.simulation import on_all_cores

from ..data import Data
from ..hypothesis import applied_effect
from ..policy import POLICY

_PROBE_STEP = 0.03  # of an unknown: the step of a difference of simulations


Part = tuple[np.ndarray | None, ...]


@dataclass(frozen=True)
class SensitivityColumn:
    """The column of one unknown in every recording, in actuator coordinates; None where it has no influence.

    `torque` on the mechanism (N, n), `tap` and `command` (N, n), `reading` (2, N, n), as in `Disturbance`.
    """

    torque: tuple[np.ndarray, ...]
    tap: Part
    command: Part
    reading: Part


@dataclass(frozen=True)
class FiniteDifference:
    """One unknown whose derivative needs a simulation: the model with a small change of it, and the size of
    that change.
    """

    model: Model
    change: float


@dataclass(frozen=True)
class Linearisation:
    """A model linearised about its runs of the first recordings.

    Motions and loops are computed when first used: finite differences of simulations need neither.

    Attributes:
        model: what ran.
        data: recordings and how they are replayed; weights are not looked at.
        runs: of the model, one for each of the first recordings.
        compliances: results of `compliance.compliance_candidates` here, by arguments.
    """

    model: Model
    data: Data
    runs: tuple[Recording, ...]
    compliances: dict[Any, Any] = field(default_factory=dict, repr=False, compare=False)

    @staticmethod
    def of(model: Model, data: Data, simulated: Sequence[Recording], count: int) -> Linearisation:
        """The linearisation about the first `count` recordings of `data` and a model's runs of them."""
        return Linearisation(model, data, tuple(simulated[:count]))

    @cached_property
    def _plant(self) -> Plant:
        return compile_plant(self.model)

    @cached_property
    def motions(self) -> tuple[Motion, ...]:
        """Return the simulated (or measured) motion of each recording."""

        def one(index: int, run: Recording) -> Motion:
            return self.data.replay.motion(self._plant, index, run)

        return tuple(on_all_cores(one, range(len(self.runs)), self.runs))

    @property
    def fitted_motions(self) -> tuple[Motion, ...]:
        """Return the motions of the recordings that are fitted."""
        return self.motions[: self.data.training]

    @cached_property
    def loops(self) -> tuple[Any, ...]:
        """Return the linearised loop of each recording."""

        def one(index: int, motion: Motion) -> Any:
            return self.data.replay.loop(self._plant, index, motion)

        return tuple(on_all_cores(one, range(len(self.runs)), self.motions))

    @property
    def has_compliance(self) -> bool:
        """Return whether the model has compliances, so that torques on links and on motors differ."""
        return any(isinstance(effect_named(e.key.effect), Compliance) for e in self.model.effects)

    @cached_property
    def has_stiction(self) -> bool:
        """Return whether dry friction holds a coordinate at rest for long.

        Small torques do not move it then, and a loop linearised about such a motion is wrong.
        """
        known = (*own_friction(self.model), *self.model.effects)
        dry = [e.key for e in known if kinds.is_dry(effect_named(e.key.effect))]
        for place in filter(None, (Placement.of(self.model, key) for key in dry)):
            moved = [np.abs(np.diff(m.along(place)[0])) / m.step for m in self.motions]
            if np.mean(np.concatenate(moved) < self.model.sliding_speed) > POLICY.sticking_rows:
                return True
        return False

    def columns(
        self, key: EffectKey, shape: Mapping[str, float], motions: Sequence[Motion] | None = None
    ) -> tuple[list[SensitivityColumn], SensitivityColumn | None]:
        """Return all linear columns of an effect and its fixed part; the effect is evaluated once for each
        recording.

        `motions`: in place of those of the model.
        """
        place, motions = Placement.of(self.model, key), self.motions if motions is None else motions
        responses = [effect_named(key.effect).response(m, self.model, place, shape) for m in motions]
        linear = [
            SensitivityColumn(
                tuple(r.columns[i] for r in responses),
                tuple(None for _ in responses),
                tuple(None if r.commands is None else r.commands[i] for r in responses),
                tuple(None if r.readings is None else r.readings[i] for r in responses),
            )
            for i in range(len(responses[0].columns))
        ]
        if responses[0].offset is None and responses[0].reading is None:
            return linear, None
        none = [np.zeros_like(m.position) for m in motions]
        fixed = SensitivityColumn(
            tuple(zero if r.offset is None else r.offset for zero, r in zip(none, responses, strict=True)),
            tuple(r.tap for r in responses),
            tuple(None for _ in responses),
            tuple(r.reading for r in responses),
        )
        return linear, fixed

    def total(
        self, applied: AppliedEffect, values: Mapping[str, float], motions: Sequence[Motion] | None = None
    ) -> SensitivityColumn:
        """Return the column of an effect with given parameter values."""
        effect = effect_named(applied.key.effect)
        coefficients, shape = effect.parameters.to_coefficients(values)
        linear, fixed = self.columns(applied.key, shape, motions)
        return combine([*linear, *([fixed] if fixed else [])], [*coefficients, *([1.0] if fixed else [])])

    def derivatives(self, applied: AppliedEffect) -> list[SensitivityColumn | FiniteDifference]:
        """Return derivatives of an effect of the model: by each coefficient, then by each nonlinear
        parameter.

        The tap is left out: a held torque that is late by a fraction of a row shows the same rows.
        """
        effect = effect_named(applied.key.effect)
        behind_springs = kinds.on_links(effect) or applied.key.location == "joint"
        if (
            kinds.by_finite_difference(effect)
            or (behind_springs and self.has_compliance)
            or self.has_stiction
            or not self.data.replay.smooth
        ):
            return [*self._trials(applied)]
        place = Placement.of(self.model, applied.key)
        motions = [effect.before(m, place, applied.values) for m in self.motions]
        coefficients, shape = effect.parameters.to_coefficients(applied.values)
        out: list[SensitivityColumn | FiniteDifference] = [*self.columns(applied.key, shape, motions)[0]]
        limits = effect.parameters.shape_bounds(self.model, place)
        for name in effect.parameters.nonlinear:
            step = max(0.05 * abs(shape[name]), 1e-12)
            if name == "time":
                step = 0.2 * motions[0].step
            low = max(shape[name] - step, limits[name][0])
            high = min(shape[name] + step, limits[name][1])
            pair = [
                self.total(
                    applied, effect.parameters.to_values(coefficients, {**shape, name: value}), motions
                )
                for value in (low, high)
            ]
            slope = combine(pair, [-1.0 / (high - low), 1.0 / (high - low)])
            out.append(replace(slope, tap=tuple(None for _ in slope.tap)))
        return out

    def _trials(self, applied: AppliedEffect) -> list[FiniteDifference]:
        """Finite differences of each unknown of an effect, with steps of `_PROBE_STEP` within its bounds."""
        effect, place = effect_named(applied.key.effect), Placement.of(self.model, applied.key)
        coefficients, shape = effect.parameters.to_coefficients(applied.values)
        lower, upper = effect.parameters.bounds(self.model, place, shape)
        limits = effect.parameters.shape_bounds(self.model, place)
        names = effect.parameters.nonlinear
        low = np.array([*lower, *(limits[name][0] for name in names)])
        high = np.array([*upper, *(limits[name][1] for name in names)])
        now = np.array([*coefficients, *(shape[name] for name in names)])
        least = np.maximum(effect.parameters.least(shape), _PROBE_STEP * _alike(effect, now))
        out = []
        for i, value in enumerate(now):
            change = least[i]
            change = change if value + change <= high[i] or value - change < low[i] else -change
            moved = now + change * (np.arange(len(now)) == i)
            count = len(coefficients)
            own = {**shape, **dict(zip(names, map(float, moved[count:]), strict=True))}
            changed = applied_effect(self.model, applied, effect.parameters.to_values(moved[:count], own))
            effects = tuple(changed if e is applied else e for e in self.model.effects)
            out.append(FiniteDifference(replace(self.model, effects=effects), change))
        return out


def _alike(effect: Effect, values: np.ndarray) -> np.ndarray:
    """Return the size of each unknown (k,); coefficients in one unit share the largest, because a zero has no
    size of its own.
    """
    units = [p.unit for p in effect.parameters if p.name not in effect.parameters.nonlinear][: len(values)]
    sizes = np.abs(values)
    for unit in set(units):
        same = np.flatnonzero([u == unit for u in units])
        sizes[same] = sizes[same].max()
    return sizes


def combine(columns: Sequence[SensitivityColumn], factors: Sequence[float]) -> SensitivityColumn:
    """Return a linear combination of columns."""

    def mixed(parts: Sequence[Part]) -> Part:
        out: list[np.ndarray | None] = []
        for own in zip(*parts, strict=True):
            there = [f * p for f, p in zip(factors, own, strict=True) if p is not None]
            out.append(np.sum(there, axis=0) if there else None)
        return tuple(out)

    torque = mixed([c.torque for c in columns])
    return SensitivityColumn(
        tuple(t for t in torque if t is not None),
        mixed([c.tap for c in columns]),
        mixed([c.command for c in columns]),
        mixed([c.reading for c in columns]),
    )
