"""The rules by which an explanation is accepted, judged on data that were not fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.effects import Parameter, effect_named
from workbench.models import AppliedEffect, Model, Placement

from .data import Data
from .hypothesis import Fit
from .policy import POLICY
from .removed_share import removed_share
from .screening.sensitivity import Column, Scene, combine

INTERVAL = 1.96  #: deviations of the 95 % interval that is reported


def floor_of_judging(data: Data) -> float:
    """Judged error that a perfect model would have, of noise and of what right simulations differ by."""
    return data.objective(data.least(held_out=data.held_out_judges))


def rejudged(old: Fit, data: Data) -> Fit:
    """The same fit under new weights; its parameters stay, so folds are judged as they are."""
    trained = data.objective(data.pool(old.mean_squares))
    if data.held_out_judges:
        folds = np.array([data.objective(ms) for ms in old.mean_squares[data.training :]])
        judged = data.objective(data.pool(old.mean_squares, held_out=True))
    else:
        folds = np.array(
            [
                np.mean(
                    np.sum(
                        (data.residual(f.recording, old.simulated[f.recording])[f.rows] * data.weight) ** 2,
                        (1, 2),
                    )
                )
                for f in data.folds
            ]
        )
        judged = trained
    return replace(old, trained=trained, judged=judged, agreeing=folds)


def overshadowed(current: Fit, data: Data) -> bool:
    """Whether training shows so much more of what is lacking that held-out motion cannot judge it."""
    if not data.held_out_judges:
        return False
    trained, held_out = (
        data.objective(data.pool(current.mean_squares, part)) / data.objective(data.pool(data.floor, part))
        for part in (False, True)
    )
    return trained > POLICY.holdout_insensitive * held_out


def unseen_on_held_out(found: Fit, current: Fit, data: Data) -> bool:
    """Whether an effect explains much of the training and nothing of held-out motion."""
    before, after = (data.score(f.mean_squares, True) for f in (current, found))
    floor = data.objective(data.pool(data.floor))
    removed = current.trained - found.trained
    unseen = abs(after - before) < POLICY.holdout_unchanged * before
    return unseen and removed > POLICY.later_gain * (current.trained - floor)


def explained(data: Data, start: Fit, end: Fit, at_end: Data) -> float:
    """Share of the excess at the start that is gone at the end, of fitted or held-out data, the smaller.

    `at_end` has the floor of the last model, whose runs noise may drive farther apart than the first's.
    """
    shares = []
    for held_out in {False, data.held_out_judges}:
        floor = data.pool(data.floor, held_out)
        first, last = data.pool(start.mean_squares, held_out), data.pool(end.mean_squares, held_out)
        before = data.objective(np.maximum(first - floor, 0.0))
        rest = np.maximum(floor, at_end.pool(at_end.floor, held_out))
        after = data.objective(np.maximum(last - POLICY.noise_slack * rest, 0.0))
        shares.append(float(np.clip(1.0 - after / before, 0.0, 1.0)) if before > 0 else 0.0)
    return min(shares)


def mostly_explained(data: Data, start: Fit, end: Fit, at_end: Data) -> float:
    """As `explained`, but the median over recordings, by their length: runs that part may end elsewhere.

    Near a gap's resonance two motions can live side by side; on which one a recording lands, no model says.
    """
    worst = 1.0
    for part in (slice(0, data.training), slice(data.training, None))[: 1 + data.held_out_judges]:
        weight = data.weight**2
        floor, rest = data.floor[part], np.maximum(data.floor, at_end.floor)[part]
        before = np.sum(np.maximum(start.mean_squares[part] - floor, 0.0) * weight, axis=(1, 2))
        last = np.maximum(end.mean_squares[part] - POLICY.noise_slack * rest, 0.0)
        after = np.sum(last * weight, axis=(1, 2))
        shares = 1.0 - after / np.maximum(before, 1e-12)
        rows = np.array([int(np.sum(r.valid)) for r in data.recordings[part]])
        order = np.argsort(shares)
        middle = np.searchsorted(np.cumsum(rows[order]), 0.5 * rows.sum())
        worst = min(worst, float(np.clip(shares[order][middle], 0.0, 1.0)))
    return worst


def as_good_as_done(current: Fit, start: Fit, data: Data) -> bool:
    """Whether even a perfect further effect could not lower the whole error by enough."""
    if _is_plain(current, data):
        return False
    if data.score(data.floor) > (1.0 - POLICY.later_fall) * data.score(current.mean_squares):
        return True
    plain = data.reweighed(start.mean_squares, POLICY.later_tolerance)
    floor, now = plain.pool(plain.floor), plain.pool(current.mean_squares)
    return bool(np.sqrt(plain.objective(floor)) > (1.0 - POLICY.later_fall) * np.sqrt(plain.objective(now)))


def helps_later(found: Fit, current: Fit, start: Fit, data: Data) -> bool:
    """Whether an effect after the first lowers the whole error, not only what the first left of its own.

    What a first effect leaves is its own shape as often as a second one. A cause that is there explains most
    of what the next one leaves, while in a model that lacks something else many take a little of it each. Or
    whether it explains nearly all of a rest that is small in the whole and yet plain to see.
    """
    if _explains_the_rest(found, current, data):
        return True
    plain = data.reweighed(start.mean_squares, POLICY.later_tolerance)
    removed = {}
    for held_out in {False, data.held_out_judges}:
        before, after, floor = (
            plain.objective(plain.pool(ms, held_out))
            for ms in (current.mean_squares, found.mean_squares, plain.floor)
        )
        if np.sqrt(after) > (1.0 - POLICY.later_fall) * np.sqrt(before):
            return False
        removed[held_out] = removed_share(before, after, floor)
    # what foretells nearly all of motion that it was not fitted on may leave more to what else is missing
    least = 0.0 if removed.get(True, 0.0) > POLICY.most_of_excess else POLICY.later_gain
    return min(removed.values()) > least


def helps_an_axis(found: Fit, current: Fit, data: Data) -> bool:
    """Whether a fit lowers the whole error of one axis, fitted and judged."""
    better = np.ones(len(data.recordings[0].axes), bool)
    for held_out in {False, data.held_out_judges}:
        before, after, floor = (
            np.sum(data.pool(ms, held_out) * data.weight**2, axis=0)
            for ms in (current.mean_squares, found.mean_squares, data.floor)
        )
        better &= np.sqrt(after) < (1.0 - POLICY.later_fall) * np.sqrt(before)
        better &= before - after > POLICY.later_gain * (before - floor)
    return bool(better.any())


def _explains_the_rest(found: Fit, current: Fit, data: Data) -> bool:
    return explains_most(found, current, data, POLICY.plain_rest_left)


def explains_most(found: Fit, current: Fit, data: Data, left: float | None = None) -> bool:
    """Whether no more than a share is `left` of a rest that is plain to see, fitted and judged."""
    left = 1.0 - POLICY.most_of_excess if left is None else left
    return _is_plain(current, data) and mends(found, current, data, left)


def _is_plain(current: Fit, data: Data) -> bool:
    """Whether a rest is plain to see, fitted and judged, however small in the whole."""
    most = POLICY.near_noise
    return current.trained > most * floor_of_fitting(data) and current.judged > most * floor_of_judging(data)


def mends(found: Fit, current: Fit, data: Data, left: float | None = None) -> bool:
    """Whether no more than a share is `left` of what is above the noise, fitted and judged.

    An exchange that leaves more than half mends nothing; one that leaves less was of a stand-in.
    """
    left = POLICY.exchange_left if left is None else left
    pairs = (
        (current.trained, found.trained, floor_of_fitting(data)),
        (current.judged, found.judged, floor_of_judging(data)),
    )
    return all(after - floor < left * (before - floor) for before, after, floor in pairs)


def nearly_at_floor(found: Fit, data: Data) -> bool:
    """Whether hardly more than the noise is left, fitted and judged."""
    most = POLICY.near_noise
    return found.trained < most * floor_of_fitting(data) and found.judged < most * floor_of_judging(data)


def floor_of_fitting(data: Data) -> float:
    """Fitted error that a perfect model would have."""
    return data.objective(data.least())


def reached(found: Fit, data: Data, times: float | None = None) -> bool:
    """Whether the noise explains the rest: `times` its error judged, and not much more fitted.

    Held-out motion that hardly shows what is lacking is explained by anything.
    """
    times = POLICY.at_noise if times is None else times
    fitted = found.trained < POLICY.near_noise * floor_of_fitting(data)
    return fitted and found.judged < times * floor_of_judging(data)


def helps(found: Fit, current: Fit, excess: float) -> bool:
    """Whether a fit is better on what it was not fitted on, by enough and on most folds."""
    # a recording that does not show the effect says neither yes nor no
    shown = np.abs(current.agreeing - found.agreeing) > POLICY.recording_shows * np.mean(current.agreeing)
    better = found.agreeing < current.agreeing
    agree = np.mean(better[shown]) if shown.any() else np.mean(better)
    return bool(current.judged - found.judged > POLICY.effect_gain * excess and agree > POLICY.fold_majority)


def explains_fitted(found: Fit, current: Fit, excess: float) -> bool:
    """Whether most of what was lacking on what was fitted is gone."""
    return current.trained - found.trained > POLICY.most_of_excess * excess


def contradicted(found: Fit, data: Data) -> bool:
    """Whether held-out motion is plainly another than the one foretold."""
    return data.held_out and _off_held_out(found, data) > POLICY.holdout_contradicts


def _off_held_out(found: Fit, data: Data) -> float:
    """Squared error on held-out recordings over that of a perfect model."""
    return data.objective(data.pool(found.mean_squares, held_out=True)) / data.objective(
        data.least(held_out=True)
    )


def spoils(found: Fit, current: Fit, data: Data) -> bool:
    """Whether held-out motion that showed nothing of what is lacking is no longer foretold."""
    return contradicted(found, data) and _off_held_out(current, data) < POLICY.holdout_informative


def lowers_error(found: Fit, current: Fit, data: Data) -> bool:
    """Whether the reported error falls, on what was fitted and on what was not."""
    if spoils(found, current, data):
        return False
    parts = {False, data.held_out_judges}
    return all(data.score(found.mean_squares, p) < data.score(current.mean_squares, p) for p in parts)


def witnessed(scene: Scene, found: Fit) -> bool:
    """Whether the recorded motions show each effect whole enough to be named, none larger than can be."""
    model = found.hypothesis.model
    return all(
        effect_named(a.key.effect).witnessed(scene.motions, Placement.of(model, a.key), a.values)
        and not _at_its_limit(model, a)
        for a in found.hypothesis.free
    )


def _at_its_limit(model: Model, applied: AppliedEffect) -> bool:
    """Whether an effect would have to be larger than physics allows: then it stands in for another."""
    effect = effect_named(applied.key.effect)
    coefficients, _ = effect.to_coefficients(applied.values)
    lower, upper = effect.bounds(model, Placement.of(model, applied.key))
    # what grows without limit ends at nothing, which a machine may well have
    limits = np.where(np.isfinite(upper) & (np.array([lower, upper]) != 0.0), [lower, upper], np.nan)
    return bool(np.isclose(coefficients, limits, rtol=1e-6, atol=0.0).any())


def stands_out(applied: AppliedEffect, deviations: float | None = None) -> bool:
    """Whether an estimate is clearly another than what has no effect.

    One that helps and may yet be nothing stands for something else: in a simulator even a lag of no length
    may change at which instant a signal is read.
    """
    return clearness(applied) > (POLICY.significant if deviations is None else deviations)


def clearness(applied: AppliedEffect) -> float:
    """How many deviations the clearest of its sizes is from what has no effect."""
    estimates = [(applied.parameters[p.name], p.neutral) for p in sizes_of(applied)]
    return max((abs(e.value - none) / max(e.std, 1e-300) for e, none in estimates), default=0.0)


def sizes_of(applied: AppliedEffect) -> Sequence[Parameter]:
    """The parameters that say how large an effect is, not where or in which shape; all where none does."""
    effect = effect_named(applied.key.effect)
    turns = [p.name for p in effect.parameters if p.upper - p.lower <= 2.0 * np.pi and p.unit == "rad"]
    sizes = [p for p in effect.parameters if p.name not in (*effect.nonlinear, *turns)]
    return sizes or effect.parameters


def cancels(scene: Scene, found: Fit) -> bool:
    """Whether effects mostly undo each other: two smooth curves that mimic a third, not two causes."""
    totals = [scene.total(a, a.values) for a in found.hypothesis.free]
    if len(totals) < 2:
        return False

    def size(column: Column) -> float:
        return float(np.sqrt(sum(np.sum(t**2) for t in column.torque)))

    return sum(map(size, totals)) > POLICY.cancelling * size(combine(totals, [1.0] * len(totals)))
