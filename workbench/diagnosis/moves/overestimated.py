"""Overestimated parameters: numbers of the model that are too large, which no added effect can reduce.

An effect adds what is missing. Where links are stated heavier or bearings rougher than they are, its nearest
to the truth is nothing, and others that bend the same curves come to the fore. Along the measured motion
inertia, damping and friction are linear, so that less than nothing can be tried there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey
from workbench.core.units import unit_text
from workbench.effects import effect_named, places
from workbench.report.wording import effect_phrase
from workbench.simulation import scored_torque

from ..data import gather_along
from ..fitting.bounded_least_squares import solve
from ..fitting.normal_equations import Normal, total
from ..loss import test_noise_floor
from ..policy import POLICY
from ..screening.equations import Entry, bounds_of, equations
from ..screening.sensitivity import Linearisation, SensitivityColumn
from ..search_result import SearchResult


@dataclass(frozen=True)
class Overestimated:
    """A reduction of parameters of the model that would explain the data.

    Attributes:
        share: of the squared error above the noise that goes, on data left out of the fit.
        parts: effect, how much of it, its deviation, and whether it would have to be less than nothing.
        at_noise: whether hardly more than the noise stays.
    """

    share: float
    parts: tuple[tuple[EffectKey, float, float, bool], ...]
    at_noise: bool

    def plainer_than(self, found: SearchResult) -> bool:
        """Return whether it explains nearly as much as effects with more parameters.

        Effects that leave nothing but noise have to have some more, and this must leave no more either.
        """
        more = found.final.hypothesis.size - len(self.parts)
        if found.consistent_after:
            return self.at_noise and more >= POLICY.too_much_fewer
        along = not found.start_data.replay.simulates
        return along and more >= 1 and 1.0 - self.share < POLICY.too_much_times * (1.0 - found.explained)

    @property
    def lines(self) -> tuple[str, ...]:
        """Return lines that say what to correct in the model's file."""
        told = [
            f"{effect_phrase(key)} {value:+.3g} ± {2.0 * deviation:.2g} {_unit(key)}".rstrip()
            for key, value, deviation, _ in self.parts
        ]
        share = f"{100.0 * self.share:.0f} % of the squared error above the noise on unseen data"
        return (
            f"a value in the model is probably too large: {', '.join(told)} would remove {share}, but "
            "effects cannot be negative; check the masses, inertias and damping in its file",
        )


def overestimated(found: SearchResult) -> Overestimated | None:
    """Overestimated parameters of the model, from the torque along the motion; None if there are none."""
    data = found.start_data
    if not data.replay.machine_alone or any(scored_torque(r) is None for r in data.recordings):
        return None
    along, simulated = gather_along(found.model, data.recordings, data.training, 0)
    linearisation = Linearisation.of(found.model, along, simulated.clean, len(along.recordings))
    columns, entries = _columns(linearisation)
    if not entries:
        return None
    whole = equations(linearisation, [], columns, entries, along)
    floor = test_noise_floor(along)
    chosen: list[Entry] = []
    before = excess = max(whole.judged(())[0] - floor, 0.0)
    while len(chosen) < len(entries):
        tried = [(whole.judged((*chosen, e))[0], e) for e in entries if e not in chosen]
        least, best = min(tried, key=lambda t: t[0])
        left = max(least - floor, 0.0)
        if before - left < max(POLICY.too_much_gain * before, POLICY.too_much_least * excess):
            break
        chosen, before = [*chosen, best], left
    if not chosen or excess <= 0.0 or before > (1.0 - POLICY.too_much_share) * excess:
        return None
    lower, upper = bounds_of(linearisation, chosen)
    bounded = whole.judged(chosen, (lower, upper))[0] - floor
    values, deviations = _spread([p.pick([k for e in chosen for k in e.linear]) for p in whole.pieces])
    below = values < lower - POLICY.sure * deviations
    if not below.any() or bounded < POLICY.too_much_times * before:
        return None
    parts = zip((e.key for e in chosen), values.tolist(), deviations.tolist(), below.tolist(), strict=True)
    return Overestimated(1.0 - before / excess, tuple(parts), before + floor < POLICY.near_noise * floor)


def _columns(linearisation: Linearisation) -> tuple[list[SensitivityColumn], list[Entry]]:
    """Return what may be too large in the model, in every place, with one column each."""
    columns: list[SensitivityColumn] = []
    entries: list[Entry] = []
    for key in places(linearisation.model):
        effect = effect_named(key.effect)
        if not effect.search.basic or len(effect.parameters.linear) != 1 or key.location != "actuator":
            continue
        linear, fixed = linearisation.columns(key, {})
        if fixed is None and len(linear) == 1:
            entries.append(Entry(key, {}, [len(columns)], None, 1.0))
            columns += linear
    return columns, entries


def _spread(pieces: Sequence[Normal]) -> tuple[np.ndarray, np.ndarray]:
    """Return the solution on all pieces, and its deviation from leaving out one piece at a time."""
    whole = total(pieces)
    parts = np.array([solve(whole - p) for p in pieces])
    size = len(parts)
    deviation = np.sqrt((size - 1) / size * np.sum((parts - parts.mean(axis=0)) ** 2, axis=0))
    return solve(whole), deviation


def _unit(key: EffectKey) -> str:
    """Return the unit of an effect's first parameter as printed."""
    return unit_text(effect_named(key.effect).parameters[0].unit)
