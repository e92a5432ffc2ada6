"""The rules by which an explanation is accepted, judged on data that were not fitted."""

from __future__ import annotations

import numpy as np

from .data import Data
from .hypothesis import Fit
from .loss import floor_of_fitting, floor_of_judging
from .policy import POLICY
from .removed_share import removed_share


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
