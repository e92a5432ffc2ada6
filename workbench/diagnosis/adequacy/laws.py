"""Torques of laws along the measured motion, and the residual they leave, on the rows that count."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey
from workbench.effects import effect_named

from ..data import Data
from ..hypothesis import Fit
from ..policy import POLICY
from ..screening.needed_torque import kept_rows, needing
from ..screening.propagation import propagate_sensitivities
from ..screening.torque_regression import Regression


@dataclass(frozen=True, eq=False)
class Laws:
    """Torques of laws on M rows of all recordings, in units of the noise.

    Attributes:
        keys: of the laws, one for each column.
        rows: of each recording, that are looked at.
        acts: torque of each law, (M, n, E): first those that were found, as they were; then basic ones.
        torque: that all of them together have to explain, (M, n).
        rest: what is left of it by those that were found, (M, n).
        noise: mean squares of the rest that noise makes, (n,).
    """

    keys: tuple[EffectKey, ...]
    rows: tuple[np.ndarray, ...]
    acts: np.ndarray
    torque: np.ndarray
    rest: np.ndarray
    noise: np.ndarray

    @property
    def above_noise(self) -> list[int]:
        """Return indices of the axes whose residual is more than noise."""
        above = np.mean(self.rest**2, axis=0) > POLICY.at_noise * self.noise
        return np.flatnonzero((self.noise > 0.0) & above).tolist()


def is_of_drives(key: EffectKey) -> bool:
    """Return whether an effect is inertia, damping or Coulomb friction of an axis, as each drive has it."""
    return key.axis is not None and effect_named(key.effect).search.basic


def laws_of(found: Fit, regression: Regression, data: Data) -> Laws:
    """Return the laws that were found and all basic ones beside them, because an unknown cause may hide any
    of those.

    Args:
        found: with all effects that were selected, along the measured motion.
        regression: from which they were.
        data: of that motion.
    """
    linearisation = regression.linearisation
    columns = [linearisation.total(a, a.values) for a in found.hypothesis.free]
    keys, motions = [a.key for a in found.hypothesis.free], needing(linearisation)
    count = len(keys)
    for entry in regression.entries:
        if effect_named(entry.key.effect).search.basic and entry.key not in keys[:count]:
            made = linearisation.columns(entry.key, entry.shape, motions)[0]
            columns, keys = [*columns, *made], [*keys, *[entry.key] * len(made)]
    parts = propagate_sensitivities([linearisation], [columns], data)[0]
    rows = tuple(kept_rows(linearisation, i) for i in range(len(linearisation.runs)))
    acts = np.concatenate([part[own, 1] for part, own in zip(parts, rows, strict=True)])
    runs = zip(found.simulated, rows, strict=True)
    rest = np.concatenate(
        [data.residual(i, run)[own, 1] * data.weight[1] for i, (run, own) in enumerate(runs)]
    )
    noise = data.least()[1] * data.weight[1] ** 2
    return Laws(tuple(keys), rows, acts, acts[:, :, :count].sum(axis=2) + rest, rest, noise)
