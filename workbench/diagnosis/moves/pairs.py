"""The move that adds two effects at once, where forward selection finds neither."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from workbench.core import EffectKey
from workbench.effects import contains, effect_named, kinds
from workbench.report.wording import effect_phrase

from ..acceptance import explains_most, improves_an_axis
from ..data import Data
from ..fitting.fit import fit, successive_halving
from ..fitting.normal_equations import Normal, total
from ..fitting.refinement import converged, with_candidates
from ..hypothesis import Fit
from ..loss import test_noise_floor
from ..policy import POLICY
from ..problem import Problem
from ..removed_share import removed_shares
from ..screening.candidate import Candidate
from ..screening.equations import Entry, equations
from ..screening.screen import entries_of
from ..screening.sensitivity import Linearisation
from ..search_result import AcceptedStep, steps_through
from .choice import loss_ratios, may_stand_together, simplest_first
from .sets import is_sound, solved_together

_RIDGE = 1e-9

Pair = tuple[Candidate, Candidate]


def best_pair(problem: Problem) -> tuple[AcceptedStep, ...]:
    """Return two steps with the pair of effects that explains most and needs both; none if no pair explains
    much.

    Every pair in every place and shape is solved on one linearisation of the loop; the best are simulated
    and fitted. There are thousands, so that more than the usual should be asked of what they lead to.

    Returns:
        Two steps, the effect that explains more by itself first; without their own data and runs.
    """
    linearisation, data, start = problem.linearisation, problem.data, problem.start
    problem.progress("looking for two causes at once")
    pairs = _screened(linearisation, data, start)[: POLICY.pairs_simulated]
    if not pairs:
        return ()
    told = [f"{effect_phrase(a.key)} with {effect_phrase(b.key)}" for a, b in pairs]
    problem.progress(f"fitting {'; '.join(told)}")
    raced, _ = successive_halving([with_candidates(linearisation, p, start) for p in pairs], start, data)
    fits = [(pair, f) for pair, f in zip(pairs, raced, strict=True) if f is not None]
    for _, found in simplest_first(fits, data, POLICY.later_gain):
        best = converged(found, data)
        if not is_sound(best, linearisation, data, start):
            continue
        singles = fit([replace(best.hypothesis, free=(a,)) for a in best.hypothesis.free], data)
        needed = [s for s in singles if s is not None and _needs_both(best, s, data)]
        if len(needed) == len(singles):
            return _steps(best, needed, fits, data, start)
    return ()


def _needs_both(both: Fit, alone: Fit, data: Data) -> bool:
    """Whether one effect alone is clearly worse than both, in total, or on one axis if a third is missing."""
    return explains_most(both, alone, data) or improves_an_axis(both, alone, data)


def _steps(
    best: Fit, singles: Sequence[Fit], fits: Sequence[tuple[Pair, Fit]], data: Data, start: Fit
) -> tuple[AcceptedStep, ...]:
    """Return the steps: first the effect that explains more by itself, then both."""
    alone = sorted(zip(best.hypothesis.free, singles, strict=True), key=lambda each: each[1].test_loss)
    keys = [applied.key for applied, _ in alone]
    left = [(applied.key, f.test_loss) for applied, f in alone]
    shares = removed_shares(start.test_loss, left, test_noise_floor(data))

    def told(key: EffectKey) -> dict[str, Any]:
        """Return pairs of the other effect with another partner than this one."""
        partner = keys[1] if key == keys[0] else keys[0]
        instead = [
            (c.key, f)
            for pair, f in fits
            for c in pair
            if partner in {p.key for p in pair} - {c.key}
            and c.key != key
            and f.training_loss < POLICY.pair_rival * best.training_loss
        ]
        tie = best.test_loss * (1.0 + POLICY.tie)
        return {
            "indistinguishable": tuple(k for k, f in instead if f.test_loss <= tie and not contains(k, key)),
            "others": tuple((k, f.hypothesis.model) for k, f in instead),
            "ranking": shares,
            "loss_ratios": loss_ratios(key, best.test_loss, ((k, f.test_loss) for k, f in instead)),
        }

    return steps_through(start, zip(keys, (alone[0][1], best), strict=True), data, told)


def _screened(linearisation: Linearisation, data: Data, start: Fit) -> list[Pair]:
    """Return pairs of effects by their loss on data they were not fitted on, each in its best shapes."""
    columns, entries = entries_of(linearisation)
    entries = [
        e for e in entries if kinds.free_parameters(effect_named(e.key.effect), linearisation.model) > 0
    ]
    rows = sum(r.position.size for r in data.recordings)
    pairs = [(a, b) for a, b in combinations(entries, 2) if may_stand_together(a.key, b.key)]
    if not pairs or 2.0 * rows * len(columns) > POLICY.pair_values:
        return []
    whole = equations(linearisation, [], columns, entries, data)
    left = left_by(total(whole.pieces), pairs)
    best: dict[tuple[EffectKey, EffectKey], tuple[float, Pair]] = {}
    for k in np.argsort(left)[: POLICY.pairs_solved]:
        one, other = pairs[k]
        test_loss, pair = solved_together((one, other), linearisation, whole)
        if (one.key, other.key) in best and best[one.key, other.key][0] <= test_loss:
            continue
        best[one.key, other.key] = test_loss, (pair[0], pair[1])
    floor = test_noise_floor(data)
    most = floor + POLICY.promising * max(start.test_loss - floor, 0.0)
    return [pair for test_loss, pair in sorted(best.values(), key=lambda jp: jp[0]) if test_loss < most]


def left_by(whole: Normal, pairs: Sequence[tuple[Entry, Entry]]) -> np.ndarray:
    """Return the squared residual (P,) of each pair without bounds, all solved together.

    Args:
        whole: normal equations of all columns.
        pairs: entries, by the numbers of their columns.
    """
    most = max(len(a.linear) + len(b.linear) for a, b in pairs)
    index, there = np.zeros((len(pairs), most), int), np.zeros((len(pairs), most), bool)
    shift = np.zeros((len(pairs), len(whole.right)), np.int8)
    for k, (a, b) in enumerate(pairs):
        own = [*a.linear, *b.linear]
        index[k, : len(own)], there[k, : len(own)] = own, True
        for e in (a, b):
            if e.fixed is not None:
                shift[k, e.fixed] = 1
    # a column without a coefficient comes off the residual first
    moved = shift @ whole.gram
    right = np.take_along_axis(whole.right - moved, index, axis=1) * there
    square = whole.square + np.einsum("pc,pc->p", shift, moved - 2.0 * whole.right)
    gram = whole.gram[index[:, :, None], index[:, None, :]] * there[:, :, None] * there[:, None, :]
    diagonal = np.einsum("pcc->pc", gram)
    scale = np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), 0.0)
    scaled = (
        gram * scale[:, :, None] * scale[:, None, :] + np.eye(most) * np.where(there, _RIDGE, 1.0)[..., None]
    )
    solution = np.linalg.solve(scaled, (right * scale)[..., None])[..., 0]
    return square - np.einsum("pc,pc->p", right * scale, solution)
