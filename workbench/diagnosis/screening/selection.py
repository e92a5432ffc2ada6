"""Sets of effects chosen together on the torque along measured motions: their gain and their cost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey
from workbench.effects import contains, effect_named, kinds

from ..policy import POLICY
from .candidate import Candidate
from .torque_regression import Chosen, Regression, Solution


@dataclass(frozen=True)
class Selection:
    """The chosen effects in the order of choice, with the fit of all of them.

    `shared`: effects that have one size, on joints of one design.
    """

    chosen: Chosen
    solution: Solution
    shared: tuple[frozenset[EffectKey], ...] = ()

    def candidates(self) -> list[Candidate]:
        """Return each effect with its coefficients."""
        out, first = [], 0
        for entry in self.chosen:
            own = self.solution.coefficients[first : first + len(entry.linear)]
            out.append(Candidate(entry.key, own, entry.shape, float(self.solution.test_loss.sum())))
            first += len(entry.linear)
        return out


def selection_of(chosen: Chosen, regression: Regression) -> Selection:
    """Return a selection with its fit."""
    return Selection(chosen, regression.solved(chosen))


def with_new(chosen: Chosen, new: Chosen) -> Chosen:
    """Return the selection with further effects, which replace their own special cases."""
    return (*(e for e in chosen if not any(contains(n.key, e.key) for n in new)), *new)


def gain_of(found: Solution, before: Solution, regression: Regression) -> np.ndarray:
    """Return the share of the excess of each axis that is removed (n,), the smaller of training and test.

    Axes where noise is all there is gain nothing.
    """
    pairs = (
        (before.validated, found.validated, regression.floor),
        (before.test_loss, found.test_loss, regression.test_floor),
    )
    gain = np.min([(old - new) / _excess(old, floor) for old, new, floor in pairs], axis=0)
    at_noise_floor = [old < POLICY.at_noise * floor for old, _, floor in pairs]
    return np.where(np.all(at_noise_floor, axis=0), np.minimum(gain, 0.0), gain)


def promised_gain(chosen: Chosen, before: Selection, regression: Regression) -> np.ndarray:
    """Return the same share for the fitted data alone (n,); other data seldom show more."""
    removed = regression.left(before.chosen) - regression.left(chosen)
    return removed / _excess(before.solution.validated, regression.floor)


def _excess(loss: np.ndarray, floor: np.ndarray) -> np.ndarray:
    """Return a loss above the noise (n,); an axis that does not count has no floor."""
    return np.maximum(loss - floor, np.maximum(1e-3 * floor, 1e-300))


def cost_of(new: Chosen) -> tuple[int, int]:
    """Return the number of free parameters and of refinements."""
    effects = [effect_named(e.key.effect) for e in new]
    free = sum(len(e.linear) + len(f.parameters.nonlinear) for e, f in zip(new, effects, strict=True))
    return free, sum(map(kinds.tier_of, effects))


def are_basic(new: Chosen) -> bool:
    """Return whether all are inertia, damping, Coulomb friction or a payload."""
    return all(effect_named(e.key.effect).search.basic for e in new)


def least_gain(new: Chosen, regression: Regression) -> float:
    """Return the smallest gain on an axis for which effects are added: low for basic effects, and for more of
    what the model has (such as another harmonic of its ripple).
    """
    known = are_basic(new) or all(
        e.key.copy > 1 or any(e.key.same_place(k) for k in regression.own) for e in new
    )
    return POLICY.effect_gain if known else POLICY.later_gain


def loss_without(out: Chosen, rest: Selection, whole: Selection, regression: Regression) -> float:
    """Return how much more a selection explains than one without some effects, over what is asked of these
    (more than 1: they are needed).
    """
    return float((gain_of(whole.solution, rest.solution, regression) / least_gain(out, regression)).max())
