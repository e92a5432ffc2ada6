"""Effects beside backlash, fitted together with it to the residual torque of inverse dynamics.

Missing torque of another cause shifts the instants at which backlash seems to be crossed, and missing
backlash biases what was identified through it: too large a link inertia hides half of it. One after the
other, neither is found well enough for a closed loop to run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import least_squares

from workbench.core import EffectKey, SimulationError
from workbench.effects import Passage, compile_plant, effect_named, kinds, link_inertia
from workbench.models import Model, Placement

from ..fitting.refinement import with_candidates
from ..hypothesis import Fit
from ..policy import POLICY
from ..screening.candidate import Candidate
from ..screening.equations import Entry, limits_of
from ..screening.screen import entries_of
from ..screening.sensitivity import Linearisation
from .choice import may_stand_together

_PROBE_STEP = 0.005  # of the load: the size of a torque in a difference
_GAP_STEP = 0.01  # of a gap and its stiffness
_TRIES = 12
_OVERFLOW = 1e9  # N m or N: for what cannot be followed at all


@dataclass(frozen=True)
class _Torque:
    """The torque, per unit coefficient, that acts at a gap.

    Attributes:
        at_motor: whether it acts ahead of the gap.
        rows: torque (N,) along each motion.
        limits: of its coefficient.
    """

    at_motor: bool
    rows: tuple[np.ndarray, ...]
    limits: tuple[float, float]

    @cached_property
    def size(self) -> float:
        """Its root mean square."""
        return float(np.sqrt(np.mean(np.concatenate(self.rows) ** 2)))


@dataclass(frozen=True)
class _Option:
    """An effect with its torques, one for each coefficient; None where a coefficient has no influence."""

    entry: Entry
    torques: tuple[_Torque | None, ...]

    @property
    def active(self) -> tuple[_Torque, ...]:
        """Return the torques that are not None."""
        return tuple(t for t in self.torques if t is not None)

    @property
    def rank(self) -> tuple[int, int]:
        """Return a sort key that puts simpler effects first."""
        return kinds.tier_of(effect_named(self.entry.key.effect)), len(self.active) + len(self.entry.shape)


class _Backlash:
    """A gap and the torques beside it, along motions."""

    def __init__(self, linearisation: Linearisation, gap: Candidate) -> None:
        place = Placement.of(linearisation.model, gap.key)
        assert place is not None
        motions = linearisation.fitted_motions
        self._pieces = [Passage.of(m, linearisation.model, place) for m in motions]
        self._inertia = link_inertia(motions[0], linearisation.model, place)[0]
        self._retardation = gap.shape.get("retardation", linearisation.model.flank_retardation_s)
        self.load = float(np.sqrt(np.mean(np.concatenate([p.load for p in self._pieces]) ** 2)))

    def left(self, torques: Sequence[_Torque], values: np.ndarray) -> np.ndarray:
        """Return the torque (M,) left unexplained, given the logarithms of gap and stiffness and then the
        coefficients.
        """
        gap, stiffness = np.exp(values[:2])
        parts = []
        for k, piece in enumerate(self._pieces):
            for torque, value in zip(torques, values[2:], strict=True):
                piece = piece.with_torque(value * torque.rows[k], torque.at_motor)
            parts.append(piece.unforeseen_means(self._inertia, gap, stiffness, self._retardation))
        left = np.nan_to_num(np.concatenate(parts), nan=_OVERFLOW, posinf=_OVERFLOW)
        return np.clip(left, -_OVERFLOW, _OVERFLOW)

    def sizes(self, torques: Sequence[_Torque]) -> np.ndarray:
        """Return steps (2 + k,) of the unknowns that change the torque by similar amounts."""
        return np.array([_GAP_STEP, _GAP_STEP, *(_PROBE_STEP * self.load / t.size for t in torques)])

    def slopes(
        self, torques: Sequence[_Torque], values: np.ndarray, now: np.ndarray, first: int = 0
    ) -> np.ndarray:
        """Derivatives (M, k) of the residual `now` by the unknowns from `first` on, per step of `sizes`."""
        steps = np.diag(self.sizes(torques))[first:]
        return np.stack([self.left(torques, values + step) - now for step in steps], axis=1)

    def fitted(self, torques: Sequence[_Torque], values: np.ndarray) -> np.ndarray:
        """Return the values (2 + k,) that leave the smallest residual, starting from given values."""
        sizes = self.sizes(torques)
        limits = (
            np.array([(-np.inf, np.inf), (-np.inf, np.inf), *(t.limits for t in torques)]) / sizes[:, None]
        )
        low, high = limits.T
        start = np.clip(values / sizes, low, high)
        found = least_squares(
            lambda x: self.left(torques, x * sizes), start, bounds=(low, high), max_nfev=_TRIES
        )
        return found.x * sizes


def beside_backlash(linearisation: Linearisation, gap: Candidate, current: Fit) -> list[Candidate]:
    """Return backlash and the other effects missing at its axis; backlash first, with its value fitted beside
    the others.

    Args:
        linearisation: of the model so far; those of its recordings that are fitted are used.
        gap: backlash fitted alone.
        current: the model's fit.

    Returns:
        Backlash alone where nothing else is missing.
    """
    seen = _Backlash(linearisation, gap)
    taken, offered = current.hypothesis.keys, _options(linearisation, gap.key)
    options = [o for o in offered if o.entry.key not in taken]
    chosen: list[_Option] = []
    values = np.log([gap.shape["gap"], gap.shape["stiffness"]])
    left = _square(seen.left((), values))
    while len(chosen) < POLICY.gap_effects:
        fitting = [o for o in options if all(may_stand_together(o.entry.key, c.entry.key) for c in chosen)]
        new = _best(seen, fitting, _torques(chosen), values)
        if new is None:
            break
        option, start = new
        more = [*chosen, option]
        better = seen.fitted(_torques(more), start)
        now = _square(seen.left(_torques(more), better))
        if now > POLICY.gap_effect_left * left:
            break
        if _can_be(with_candidates(linearisation, _candidates(more, better[2:], gap), current).model):
            chosen, values, left = more, better, now
        else:
            options.remove(option)
    if not chosen:
        return [gap]
    others = _candidates(chosen, values[2:], gap)
    return [_again(linearisation, gap, others, current), *others]


def _can_be(model: Model) -> bool:
    """Return whether bodies with such inertias are physically possible."""
    try:
        compile_plant(model)
    except SimulationError:
        return False
    return True


def _options(linearisation: Linearisation, gap: EffectKey) -> list[_Option]:
    """Return the effects that are torques at the axis of a gap."""
    place = Placement.of(linearisation.model, gap)
    assert place is not None
    columns, entries = entries_of(linearisation)
    least = 1e-9 * max(float(np.sqrt(np.mean(m.torque**2))) for m in linearisation.fitted_motions)
    options = []
    for entry in entries:
        at_motor = (entry.key.axis, entry.key.location) == (gap.axis, "actuator")
        torques: list[_Torque | None] = []
        for number, low, high in zip(entry.linear, *limits_of(linearisation.model, entry), strict=True):
            rows = tuple(t[:, place.index] for t in columns[number].torque[: linearisation.data.training])
            torque = _Torque(at_motor, rows, (low, high))
            torques.append(torque if torque.size > least else None)
        if entry.fixed is None and any(torques):
            options.append(_Option(entry, tuple(torques)))
    return options


def _best(
    seen: _Backlash, options: Sequence[_Option], torques: Sequence[_Torque], values: np.ndarray
) -> tuple[_Option, np.ndarray] | None:
    """Return the simplest of the options that leave about the smallest residual, and starting values; uses
    slopes only.
    """
    now = seen.left(torques, values)
    known = seen.slopes(torques, values, now)
    tried_options: list[tuple[float, _Option, np.ndarray]] = []
    for option in options:
        all_torques = [*torques, *option.active]
        start = np.append(values, np.zeros(len(option.active)))
        slopes = np.hstack([known, seen.slopes(all_torques, start, now, len(values))])
        change = np.linalg.lstsq(slopes, -now, rcond=None)[0]
        moved = start + change * seen.sizes(all_torques)
        within = zip(moved[len(values) :], option.active, strict=True)
        if all(t.limits[0] <= x <= t.limits[1] for x, t in within):
            tried_options.append((_square(now + slopes @ change), option, moved))
    if not tried_options:
        return None
    enough = POLICY.gap_simpler * min(left for left, _, _ in tried_options)
    _, option, moved = min((j for j in tried_options if j[0] <= enough), key=lambda j: (j[1].rank, j[0]))
    return option, moved


def _torques(chosen: Sequence[_Option]) -> list[_Torque]:
    return [t for option in chosen for t in option.active]


def _candidates(chosen: Sequence[_Option], coefficients: np.ndarray, gap: Candidate) -> list[Candidate]:
    values = iter(coefficients)
    return [
        Candidate(
            o.entry.key,
            np.array([0.0 if t is None else next(values) for t in o.torques]),
            o.entry.shape,
            gap.test_loss,
        )
        for o in chosen
    ]


def _again(
    linearisation: Linearisation, gap: Candidate, others: Sequence[Candidate], current: Fit
) -> Candidate:
    """Return the gap as it appears in a model that has the other effects."""
    model = with_candidates(linearisation, others, current).model
    seen = Linearisation(model, linearisation.data, linearisation.runs[: linearisation.data.training])
    initial_values = effect_named(gap.key.effect).initial_values(
        seen.motions, model, Placement.of(model, gap.key)
    )
    shape: Mapping[str, float] = initial_values[0][0] if initial_values else gap.shape
    return replace(gap, shape=shape)


def _square(left: np.ndarray) -> float:
    return float(left @ left)
