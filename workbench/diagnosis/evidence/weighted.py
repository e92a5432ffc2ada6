"""Weighted means and slopes over frequency."""

from __future__ import annotations

import numpy as np

BANDS = 5  # stretches of a response that are compared with each other


def weighted_mean(values: np.ndarray, weight: np.ndarray) -> tuple[float, float]:
    """Return the weighted mean and its deviation, by the noise or by the scatter, whichever is larger."""
    mean = float(np.average(values, weights=weight))
    excess = float(np.sum(weight * (values - mean) ** 2) / max(len(values) - 1, 1))
    return mean, float(np.sqrt(max(excess, 1.0) / weight.sum()))


def weighted_slope(x: np.ndarray, y: np.ndarray, weight: np.ndarray) -> tuple[float, float]:
    """Return the slope of a line through zero and its deviation, by the noise or by the scatter."""
    information = float(np.sum(weight * x**2))
    slope = float(np.sum(weight * x * y) / information)
    excess = float(np.sum(weight * (y - slope * x) ** 2) / max(len(x) - 1, 1))
    return slope, float(np.sqrt(max(excess, 1.0) / information))


def in_bands(omega: np.ndarray, values: np.ndarray, weight: np.ndarray) -> list[tuple[float, float, float]]:
    """Return middle frequency, mean and deviation of stretches of neighbouring lines."""
    parts = np.array_split(np.arange(len(omega)), BANDS)
    return [(float(np.mean(omega[p])), *weighted_mean(values[p], weight[p])) for p in parts if len(p)]
