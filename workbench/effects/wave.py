"""Unknowns of a wave: its sine and cosine, in which it is linear, in place of amplitude and phase."""

from __future__ import annotations

import numpy as np

from .parameter import INF, Chart, Unknown, Values


def wave(amplitude: str, phase: str, top: float = INF, *others: Unknown) -> Chart:
    """Return sine and cosine in place of amplitude and phase, each up to `top` in both directions; beside
    `others`.
    """

    def values(coefficients: np.ndarray, shape: Values) -> dict[str, float]:
        sine, cosine = map(float, coefficients)
        found = {amplitude: float(np.hypot(sine, cosine)), phase: float(np.arctan2(cosine, sine))}
        return {**found, **shape}

    def solved(values: Values) -> tuple[np.ndarray, dict[str, float]]:
        parts = np.array([np.cos(values[phase]), np.sin(values[phase])])
        return values[amplitude] * parts, {u.name: values[u.name] for u in others}

    pair = (Unknown("sine", lower=-top, upper=top), Unknown("cosine", lower=-top, upper=top))
    return Chart((*pair, *others), values, solved)
