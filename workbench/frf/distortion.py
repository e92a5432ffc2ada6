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
from .silent import residuals

_SURE = 1e-3  # chance of calling noise a distortion


@dataclass(frozen=True, eq=False)
class Distortion:
    """Levels at one set of experiments: root mean squares over experiments, in the outputs' units.

    Every level is that of one experiment's mean over its periods; noise is that of the same mean.

    Attributes:
        outputs: names of the outputs, length ny.
        frequency: excited lines [Hz], (F,).
        level, noise: output and its noise at these, (F, ny).
        odd_frequency, odd, odd_noise: silent odd lines (A,), what is there, and the noise there, (A, ny).
        even_frequency, even, even_noise: the same at even lines, (B,) and (B, ny).
        odd_share, even_share: distortion (noise subtracted) as a part of the output's level, rms over the
            band, (ny,); 0 where it does not stand out of the noise, NaN where no line listens.
        odd_found, even_found: whether it stands out at the 0.1 % level, (ny,) bool.
    """

    outputs: tuple[str, ...]
    frequency: np.ndarray
    level: np.ndarray
    noise: np.ndarray
    odd_frequency: np.ndarray
    odd: np.ndarray
    odd_noise: np.ndarray
    even_frequency: np.ndarray
    even: np.ndarray
    even_noise: np.ndarray
    odd_share: np.ndarray
    even_share: np.ndarray
    odd_found: np.ndarray
    even_found: np.ndarray


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
    ny = g.shape[1]
    here = m.at(m.lines)
    free = sum(s.free for s in m.spectra)
    found = [_levels(m, g, lines) for lines in m.listening]
    level = np.sqrt(np.mean([np.abs(s.mean[here, :ny]) ** 2 for s in m.spectra], axis=0))
    own = [np.einsum("fii->fi", s.covariance[here, :ny, :ny]).real / s.periods for s in m.spectra]
    noise = np.sum([s.free * o for s, o in zip(m.spectra, own, strict=True)], axis=0) / free
    shares, sure = [], []
    for power, quiet in found:
        if not len(power):  # no line of this parity was left silent
            shares.append(np.full(ny, np.nan))
            sure.append(np.zeros(ny, bool))
            continue
        above, total = np.maximum(power - quiet, 0).mean(axis=0), np.mean(level**2, axis=0)
        count = 2 * power.shape[0] * len(m.spectra)
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio = power.mean(axis=0) / quiet.mean(axis=0)
        chance = scipy.stats.f.sf(ratio, count, 2 * max(free, 1) * power.shape[0])
        stands = (chance < _SURE) & (above > 1e-12 * total)
        share = np.sqrt(np.maximum(power.mean(axis=0) - quiet.mean(axis=0), 0) / total)
        shares.append(np.where(stands, share, 0.0))
        sure.append(stands)
    return Distortion(
        outputs=tuple(str(c) for c in m.choice.channels(m.recordings[0])[0]),
        frequency=m.frequency[here],
        level=level,
        noise=np.sqrt(noise),
        odd_frequency=m.frequency[m.at(m.listening[0])],
        odd=np.sqrt(found[0][0]),
        odd_noise=np.sqrt(found[0][1]),
        even_frequency=m.frequency[m.at(m.listening[1])],
        even=np.sqrt(found[1][0]),
        even_noise=np.sqrt(found[1][1]),
        odd_share=shares[0],
        even_share=shares[1],
        odd_found=sure[0],
        even_found=sure[1],
    )


def _levels(m: Measured, g: np.ndarray, lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean square over experiments at unexcited lines, and that of the noise, each (A, ny)."""
    if len(lines) == 0:
        nothing = np.zeros((0, g.shape[1]))
        return nothing, nothing
    residual, quiet = residuals(m, g, lines)
    return np.mean(np.abs(residual) ** 2, axis=0), np.einsum("aii->ai", quiet).real
