"""What running a model on recordings gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import Recording

from .noise import NoiseModel
from .score import scored_signals, squares

_MOST = 1e-3  # of a signal's deviation


@dataclass(frozen=True)
class Simulated:
    """A model's runs of recordings, without noise and with it.

    `clean`: one a recording. `noisy`: one list a draw. `noise`: the sensors. `shifted`: one a recording, from
    a machine that no one would call another (see `ClosedLoop`); none where that is not known.
    """

    recordings: tuple[Recording, ...]
    clean: tuple[Recording, ...]
    noisy: tuple[tuple[Recording, ...], ...]
    noise: NoiseModel
    shifted: tuple[Recording, ...] = ()

    def immaterial(self, index: int) -> np.ndarray:
        """Sums of squares (2, n) by which two right simulations of a recording may differ.

        Never much: where a loop magnifies the shift without end, that is no licence for any error.
        """
        clean, names = self.clean[index], scored_signals(self.recordings[index])
        if not self.shifted:
            return np.zeros((2, len(clean.axes)))
        still = clean.with_signals(**{n: clean.signals[n] * 0 + clean.signals[n].mean(axis=0) for n in names})
        apart, size = (squares(other, clean, names) for other in (self.shifted[index], still))
        return np.nan_to_num(np.minimum(apart, _MOST**2 * size))
