"""Rules that accept a fit in place of another, tested on data that were not fitted."""

from __future__ import annotations

import numpy as np

from .data import Data
from .hypothesis import Fit
from .loss import test_noise_floor, training_noise_floor
from .policy import POLICY
from .removed_share import removed_share


def holdout_insensitive(current: Fit, data: Data) -> bool:
    """Return whether training shows so much more excess error that held-out motion cannot test it."""
    if not data.tests_on_holdout:
        return False
    training_loss, held_out = (
        data.objective(data.pool(current.mean_squares, part)) / data.objective(data.pool(data.floor, part))
        for part in (False, True)
    )
    return training_loss > POLICY.holdout_insensitive * held_out


def unchanged_on_holdout(found: Fit, current: Fit, data: Data) -> bool:
    """Return whether an effect explains much of the training error and does not change the held-out error."""
    before, after = (data.score(f.mean_squares, True) for f in (current, found))
    floor = data.objective(data.pool(data.floor))
    removed = current.training_loss - found.training_loss
    unseen = abs(after - before) < POLICY.holdout_unchanged * before
    return unseen and removed > POLICY.later_gain * (current.training_loss - floor)


def too_little_left(current: Fit, start: Fit, data: Data) -> bool:
    """Return whether even a perfect further effect could not lower the total error by enough."""
    if _is_clear(current, data):
        return False
    if data.score(data.floor) > (1.0 - POLICY.later_fall) * data.score(current.mean_squares):
        return True
    plain = data.reweighed(start.mean_squares, POLICY.later_tolerance)
    floor, now = plain.pool(plain.floor), plain.pool(current.mean_squares)
    return bool(np.sqrt(plain.objective(floor)) > (1.0 - POLICY.later_fall) * np.sqrt(plain.objective(now)))


def improves_residual(found: Fit, current: Fit, start: Fit, data: Data) -> bool:
    """Return whether an effect after the first lowers the total error, not only the excess left by the first.

    What a first effect leaves is its own shape as often as a second one. A cause that is there explains most
    of what the next one leaves, while in a model that lacks something else many take a little of it each. Or
    whether it explains nearly all of a rest that is small in the whole and yet plain to see.
    """
    if explains_most(found, current, data, POLICY.plain_rest_left):
        return True
    plain = data.reweighed(start.mean_squares, POLICY.later_tolerance)
    removed = {}
    for held_out in {False, data.tests_on_holdout}:
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


def improves_an_axis(found: Fit, current: Fit, data: Data) -> bool:
    """Return whether a fit lowers the total error of one axis, in training and test."""
    better = np.ones(len(data.recordings[0].axes), bool)
    for held_out in {False, data.tests_on_holdout}:
        before, after, floor = (
            np.sum(data.pool(ms, held_out) * data.weight**2, axis=0)
            for ms in (current.mean_squares, found.mean_squares, data.floor)
        )
        better &= np.sqrt(after) < (1.0 - POLICY.later_fall) * np.sqrt(before)
        better &= before - after > POLICY.later_gain * (before - floor)
    return bool(better.any())


def explains_most(found: Fit, current: Fit, data: Data, left: float | None = None) -> bool:
    """Return whether a clear excess falls to the share `left`, in training and test."""
    left = 1.0 - POLICY.most_of_excess if left is None else left
    return _is_clear(current, data) and halves_excess(found, current, data, left)


def _is_clear(current: Fit, data: Data) -> bool:
    """Return whether the excess is clear in training and test, even if it is small beside the total error."""
    most = POLICY.near_noise
    return current.training_loss > most * training_noise_floor(
        data
    ) and current.test_loss > most * test_noise_floor(data)


def halves_excess(found: Fit, current: Fit, data: Data, left: float | None = None) -> bool:
    """Return whether the excess above the noise falls to the share `left`, in training and test.

    A replacement that leaves more than half is no improvement; one that leaves less replaced a wrong effect.
    Below the noise there is nothing left to halve.
    """
    left = POLICY.exchange_left if left is None else left
    floors = np.array([training_noise_floor(data), test_noise_floor(data)])
    before, after = (np.maximum([f.training_loss, f.test_loss] - floors, 0.0) for f in (current, found))
    return bool(before.any() and np.all(after <= left * before))


def near_noise_floor(found: Fit, data: Data) -> bool:
    """Return whether hardly more than the noise is left, in training and test."""
    most = POLICY.near_noise
    return found.training_loss < most * training_noise_floor(
        data
    ) and found.test_loss < most * test_noise_floor(data)


def at_noise_floor(found: Fit, data: Data, times: float | None = None) -> bool:
    """Return whether noise explains the rest: test loss at most `times` its floor, and a low training loss.

    Held-out motion that hardly shows what is missing is explained by anything.
    """
    times = POLICY.at_noise if times is None else times
    fitted = found.training_loss < POLICY.near_noise * training_noise_floor(data)
    return fitted and found.test_loss < times * test_noise_floor(data)


def improves(found: Fit, current: Fit, excess: float) -> bool:
    """Return whether a fit is better on data it was not fitted on, by enough and on most folds."""
    # a recording that does not show the effect says neither yes nor no
    shown = np.abs(current.fold_losses - found.fold_losses) > POLICY.recording_shows * np.mean(
        current.fold_losses
    )
    better = found.fold_losses < current.fold_losses
    agree = np.mean(better[shown]) if shown.any() else np.mean(better)
    return bool(
        current.test_loss - found.test_loss > POLICY.effect_gain * excess and agree > POLICY.fold_majority
    )


def contradicts_holdout(found: Fit, data: Data) -> bool:
    """Return whether the held-out error is far above that of a perfect model."""
    return data.held_out and _off_held_out(found, data) > POLICY.holdout_contradicts


def _off_held_out(found: Fit, data: Data) -> float:
    """Return the squared error on held-out recordings divided by that of a perfect model."""
    return data.objective(data.pool(found.mean_squares, held_out=True)) / data.objective(
        data.least(held_out=True)
    )


def degrades_holdout(found: Fit, current: Fit, data: Data) -> bool:
    """Return whether the held-out error was at the noise before and is far above it now."""
    return contradicts_holdout(found, data) and _off_held_out(current, data) < POLICY.holdout_informative


def lowers_error(found: Fit, current: Fit, data: Data) -> bool:
    """Return whether the reported error falls, on fitted data and on other data."""
    if degrades_holdout(found, current, data):
        return False
    parts = {False, data.tests_on_holdout}
    return all(data.score(found.mean_squares, p) < data.score(current.mean_squares, p) for p in parts)
