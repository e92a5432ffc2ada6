"""Resonances and anti-resonances read from a response, with intervals and without a model of the whole."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

from workbench.core import Estimate, InputError

from .response import Frf

_LINES = 4  # to each side that are fitted at least; a well damped one takes more
_WIDEST = 0.3  # damping ratio beyond which a top or dip is none


@dataclass(frozen=True)
class Resonance:
    """One peak or dip: natural `frequency` [Hz], `damping` ratio, and the response's `magnitude` there."""

    kind: Literal["resonance", "antiresonance"]
    frequency: Estimate
    damping: Estimate
    magnitude: float


def find_resonances(
    frf: Frf, output: int = 0, input: int = 0, *, prominence_db: float = 3.0
) -> list[Resonance]:
    """Return peaks and dips of the acceleration that a response implies, lowest frequency first.

    A complex polynomial of order two is fitted to the response (near a dip) or to its inverse (near a top)
    over a few lines; it is smooth there, and its complex root is the natural frequency with its damping.

    Args:
        frf: measured response.
        output, input: which entry.
        prominence_db: how far a top or dip stands out of its surroundings, beside four deviations of noise.

    Raises:
        InputError: fewer lines than a fit needs.
    """
    if len(frf) < 2 * _LINES + 1:
        raise InputError(f"{len(frf)} lines are too few for fits over {2 * _LINES + 1}", remedy="excite more")
    g, std = frf.response[:, output, input], frf.std[:, output, input]
    derivatives = {"velocity": 1, "velocity_reference": 1}.get(frf.outputs[output].signal, 2)
    size = np.abs(g)
    level = 20 * np.log10(np.maximum(size, 1e-300)) + 20 * derivatives * np.log10(frf.omega)
    noise = 20 / np.log(10) * std / np.maximum(size, 1e-300) / np.sqrt(2)
    found = []
    for kind, sign in (("resonance", 1.0), ("antiresonance", -1.0)):
        places, properties = scipy.signal.find_peaks(sign * level, prominence=prominence_db)
        for place, prominence in zip(places, properties["prominences"], strict=True):
            # the neighbours' noise as well: a top that noise made looks sure of itself
            near = slice(max(place - _LINES, 0), place + _LINES + 1)
            if prominence > 4 * max(noise[place], np.median(noise[near])):
                found += _first_fitted(frf, g, std, int(place), kind)
    return sorted(found, key=lambda r: r.frequency.value)


def _first_fitted(frf: Frf, g: np.ndarray, std: np.ndarray, place: int, kind: str) -> list[Resonance]:
    """Return the fit over the narrowest band that contains the whole peak or dip: a damped one is wide."""
    width = _LINES
    while 2 * width + 1 <= len(frf):
        fitted = _fitted(frf, g, std, place, kind, width)
        # over a wide stretch a polynomial makes a root of anything
        if fitted is not None and (width == _LINES or abs(fitted.damping.value) < _WIDEST):
            return [fitted]
        width *= 2
    return []


def _fitted(frf: Frf, g: np.ndarray, std: np.ndarray, place: int, kind: str, lines: int) -> Resonance | None:
    first = int(np.clip(place - lines, 0, len(frf) - 2 * lines - 1))
    here = slice(first, first + 2 * lines + 1)
    centre = frf.frequency[place]
    scale = np.abs(frf.frequency[here] - centre).max()
    x = (frf.frequency[here] - centre) / scale
    y, deviation = g[here], np.maximum(std[here], 1e-9 * np.abs(g[here]).max())
    if kind == "resonance":
        y, deviation = 1 / y, deviation / np.abs(y) ** 2
    basis = np.vander(x, 3, increasing=True) / deviation[:, None]
    inverse = np.linalg.inv(basis.T @ basis)
    coefficients = inverse @ basis.T @ (y / deviation)
    # where a polynomial is not enough, what it leaves counts as error
    rest = np.sum(np.abs(basis @ coefficients - y / deviation) ** 2) / (len(x) - 3)
    roots = np.roots(coefficients[::-1])
    if len(roots) == 0:
        return None
    root = roots[np.argmin(np.abs(roots))]
    slope = coefficients[1] + 2 * coefficients[2] * root
    at = np.array([1.0, root, root**2])
    variance = float(np.real(at @ inverse @ at.conj())) * max(1.0, rest) / np.abs(slope) ** 2
    pole = centre + scale * root
    natural, half = float(np.abs(pole)), float(scale * np.sqrt(variance / 2))
    if abs(scale * root) > 2 * scale:
        return None  # the top is not one of a root near the axis
    return Resonance(
        kind="resonance" if kind == "resonance" else "antiresonance",
        frequency=Estimate(natural, half, "Hz"),
        damping=Estimate(float(pole.imag / natural), half / natural, "1"),
        magnitude=float(np.abs(g[place])),
    )
