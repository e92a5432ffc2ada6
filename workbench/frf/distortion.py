"""Noise, even and odd nonlinear distortion told apart on lines where nothing was excited.

A response to odd lines contains, at even lines, only what an even nonlinearity made, and at odd lines that
stayed silent, only what an odd one made; noise is on all of them, and the periods tell how much. Pintelon
and Schoukens 2012, ch. 4 (detection lines).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from workbench.core import InputError, Recording

from .estimate import frf_of
from .measure import Measured, measure
from .unexcited_lines import residuals

_SURE = 1e-3  # chance of calling noise a distortion


@dataclass(frozen=True, eq=False)
class Distortion:
    """Distortion as a part of an output's level at the excited lines, rms over the band, noise subtracted.

    It is 0 where it does not stand out of the noise at the 0.1 % level, NaN where no line listens.

    Attributes:
        odd: at silent odd lines, (ny,).
        even: at even lines, (ny,).
    """

    odd: np.ndarray
    even: np.ndarray


def distortion(recordings: Sequence[Recording], **options: object) -> Distortion:
    """Return even and odd distortion of one set of experiments with an odd (random) multisine.

    Args:
        recordings: one experiment or several about one posture.
        options: as `estimate`: input, output, reference, axes, period_s, lines, transient_periods,
            leakage.

    Raises:
        InputError: as `estimate`, or the excitation left no line silent.
    """
    m = measure(recordings, **options)  # type: ignore[arg-type]
    g = frf_of(m, "fast").response
    if not len(m.listening[0]) and not len(m.listening[1]):
        raise InputError(
            "no line of the band was left unexcited", file=recordings[0].source, column="excitation.lines",
            remedy="excite odd lines only, some of them left out (grid 'odd_random')",
        )  # fmt: skip
    here, ny = m.at(m.lines), g.shape[1]
    level = np.mean([np.abs(s.mean[here, :ny]) ** 2 for s in m.spectra], axis=(0, 1))
    odd, even = (_share(m, g, lines, level) for lines in m.listening)
    return Distortion(odd, even)


def _share(m: Measured, g: np.ndarray, lines: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Return the share (ny,) at some unexcited lines; `level` is the mean square at the excited ones."""
    if not len(lines):
        return np.full(len(level), np.nan)
    residual, covariance = residuals(m, g, lines)
    found = np.mean(np.abs(residual) ** 2, axis=(0, 1))
    noise = np.einsum("aii->i", covariance).real / len(lines)
    free = max(sum(s.free for s in m.spectra), 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        chance = scipy.stats.f.sf(found / noise, 2 * len(lines) * len(m.spectra), 2 * free * len(lines))
    above = np.maximum(found - noise, 0.0)
    return np.where((chance < _SURE) & (above > 1e-12 * level), np.sqrt(above / level), 0.0)
