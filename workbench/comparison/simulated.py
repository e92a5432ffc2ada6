"""Result of simulating a model on recordings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import Recording

from .noise import NoiseModel
from .score import scored_signals, squares

_MOST = 1e-3  # of a signal's deviation


@dataclass(frozen=True)
class Simulated:
    """Runs of a model on recordings, without noise and with it.

    `clean`: one per recording. `noisy`: one list per draw. `noise`: the sensors. `shifted`, `creeping`: one a
    recording, from machines that no one would call another (see `ClosedLoop`); none where that is not known.
    """

    recordings: tuple[Recording, ...]
    clean: tuple[Recording, ...]
    noisy: tuple[tuple[Recording, ...], ...]
    noise: NoiseModel
    shifted: tuple[Recording, ...] = ()
    creeping: tuple[Recording, ...] = ()

    def immaterial(self, index: int) -> np.ndarray:
        """Return the sums of squares (2, n) by which two right simulations of a recording may differ.

        Never much: where a loop magnifies the difference without end, that is no licence for any error. What
        creeps at rest is held by its loop: torque may differ by as much as that motion makes of it.
        """
        clean, names = self.clean[index], scored_signals(self.recordings[index])
        if not (self.shifted or self.creeping):
            return np.zeros((2, len(clean.axes)))
        still = clean.with_signals(**{n: clean.signals[n] * 0 + clean.signals[n].mean(axis=0) for n in names})
        most, out = _MOST**2 * squares(still, clean, names), np.zeros((2, len(clean.axes)))
        if self.shifted:
            out += np.nan_to_num(np.minimum(squares(self.shifted[index], clean, names), most))
        if self.creeping:
            apart = np.nan_to_num(squares(self.creeping[index], clean, names))
            out += apart * np.minimum(1.0, most[0] / np.maximum(apart[0], 1e-300))
        return out
