"""The move that adds two effects at once, where forward selection finds neither."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from workbench.core import EffectKey
from workbench.effects import contains, effect_named, kinds

from ..acceptance import degrades_holdout, explains_most, improves_an_axis
from ..data import Data
from ..fitting.fit import fit, successive_halving
from ..fitting.normal_equations import Normal, total
from ..fitting.refinement import converged, with_candidates
from ..hypothesis import Fit
from ..loss import test_noise_floor
from ..policy import POLICY
from ..removed_share import removed_shares
from ..screening.candidate import Candidate
from ..screening.equations import Entry, equations, judge, limits_of
from ..screening.screen import entries_of
from ..screening.sensitivity import Linearisation
from ..search_result import AcceptedStep
from ..significance import cancel_each_other, identifiable
from .choice import loss_ratios, simplest_first

_RIDGE = 1e-9

Pair = tuple[Candidate, Candidate]


@dataclass(frozen=True)
class _Fitted:
    """A pair with its fit."""

    pair: Pair
    fit: Fit


def best_pair(
    linearisation: Linearisation, data: Data, start: Fit, progress: Callable[[str], None]
) -> tuple[AcceptedStep, AcceptedStep] | None:
    """Two steps with the pair of effects that explains most, both needed; None where no pair explains much.

    Every pair in every place and shape is solved on one linearisation of the loop; the best are simulated
    and fitted. There are thousands, so that more than the usual should be asked of what they lead to.

    Args:
        linearisation: of the model so far.
        data: its recordings.
        start: the model as it is.
        progress: told what is being done.

    Returns:
        Two steps, the effect that explains more by itself first; without their own data and runs.
    """
    progress("looking for two causes at once")
    pairs = _screened(linearisation, data, start)[: POLICY.pairs_simulated]
    if not pairs:
        return None
    progress(f"fitting {', '.join(f'{a.key} with {b.key}' for a, b in pairs)}")
    tried = [with_candidates(linearisation, pair, start) for pair in pairs]
    fits = [
        _Fitted(p, f)
        for p, f in zip(pairs, successive_halving(tried, start, data)[0], strict=True)
        if f is not None
    ]
    for found in simplest_first(fits, data, POLICY.later_gain):
        best = replace(found, fit=converged(found.fit, data))
        sound = identifiable(linearisation, best.fit) and not cancel_each_other(linearisation, best.fit)
        if not sound or degrades_holdout(best.fit, start, data) or not explains_most(best.fit, start, data):
            continue
        free = best.fit.hypothesis.free
        singles = fit([replace(best.fit.hypothesis, free=(a,)) for a in free], data)
        if all(s is not None and _needs_both(best.fit, s, data) for s in singles):
            return _steps(best, [s for s in singles if s is not None], fits, data, start)
    return None


def _needs_both(both: Fit, alone: Fit, data: Data) -> bool:
    """Whether one effect leaves clearly more than both, in total, or on one axis where a third is missing."""
    return explains_most(both, alone, data) or improves_an_axis(both, alone, data)


def _steps(
    best: _Fitted, singles: Sequence[Fit], fits: Sequence[_Fitted], data: Data, start: Fit
) -> tuple[AcceptedStep, AcceptedStep]:
    """First the effect that does more by itself, then both."""
    order = sorted(range(2), key=lambda k: singles[k].test_loss)
    keys = [best.fit.hypothesis.free[k].key for k in order]
    floor = test_noise_floor(data)
    alone = [(key, singles[k].test_loss) for key, k in zip(keys, order, strict=True)]
    shares = removed_shares(start.test_loss, alone, floor)
    before = (start, singles[order[0]])
    steps = []
    for n, result in enumerate((singles[order[0]], best.fit)):
        partner = keys[1 - n]
        instead = [
            (_other(f.pair, partner), f.fit)
            for f in fits
            if partner in {c.key for c in f.pair}
            and _other(f.pair, partner) != keys[n]
            and f.fit.training_loss < POLICY.pair_rival * best.fit.training_loss
        ]
        steps.append(
            AcceptedStep.between(
                before[n],
                result,
                keys[n],
                data,
                indistinguishable=tuple(
                    k
                    for k, f in instead
                    if f.test_loss <= best.fit.test_loss * (1.0 + POLICY.tie) and not contains(k, keys[n])
                ),
                others=tuple((k, f.hypothesis.model) for k, f in instead),
                ranking=shares,
                loss_ratios=loss_ratios(keys[n], best.fit.test_loss, ((k, f.test_loss) for k, f in instead)),
            )
        )
    return steps[0], steps[1]


def _other(pair: Pair, key: EffectKey) -> EffectKey:
    return next(c.key for c in pair if c.key != key)


def _screened(linearisation: Linearisation, data: Data, start: Fit) -> list[Pair]:
    """Pairs of effects by what they leave on data that they were not fitted on, the best shapes of each."""
    columns, entries = entries_of(linearisation)
    entries = [
        e for e in entries if kinds.free_parameters(effect_named(e.key.effect), linearisation.model) > 0
    ]
    rows = sum(r.position.size for r in data.recordings)
    pairs = [(a, b) for a, b in combinations(entries, 2) if may_stand_together(a.key, b.key)]
    if not pairs or 2.0 * rows * len(columns) > POLICY.pair_values:
        return []
    pieces, held_out = equations(linearisation, [], columns, data, start.simulated)
    left = left_by(total(pieces), pairs)
    best: dict[tuple[EffectKey, EffectKey], tuple[float, Pair]] = {}
    for k in np.argsort(left)[: POLICY.pairs_solved]:
        one, other = pairs[k]
        bounds = tuple(
            np.concatenate(b)
            for b in zip(limits_of(linearisation, one), limits_of(linearisation, other), strict=True)
        )
        fixed = [e.fixed for e in (one, other) if e.fixed is not None]
        test_loss, solution = judge(
            pieces, held_out, [*one.linear, *other.linear], fixed, (bounds[0], bounds[1])
        )
        if (one.key, other.key) in best and best[one.key, other.key][0] <= test_loss:
            continue
        parts = np.split(solution, [len(one.linear)])
        first, second = (
            Candidate(e.key, x, e.shape, test_loss) for e, x in zip((one, other), parts, strict=True)
        )
        best[one.key, other.key] = test_loss, (first, second)
    floor = test_noise_floor(data)
    most = floor + POLICY.promising * max(start.test_loss - floor, 0.0)
    return [pair for test_loss, pair in sorted(best.values(), key=lambda jp: jp[0]) if test_loss < most]


def may_stand_together(one: EffectKey, other: EffectKey) -> bool:
    """Whether two effects are neither two forms of one cause nor dry frictions that share a stiction."""
    if one == other or contains(one, other) or contains(other, one):
        return False
    return not (
        kinds.is_dry(effect_named(one.effect))
        and kinds.is_dry(effect_named(other.effect))
        and one.axis == other.axis
    )


def left_by(whole: Normal, pairs: Sequence[tuple[Entry, Entry]]) -> np.ndarray:
    """Squared residual that each pair leaves without bounds, (P,), all solved side by side.

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
