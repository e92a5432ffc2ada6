"""Whether noise alone explains an error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import ndtr, ndtri

from workbench.core import HOPELESS, MARGIN_SIGNAL, MARGIN_TOTAL, Outlier

from .score import Scale, normalised

_DEVIATIONS = 3.0  # by which an error may exceed its floor by chance


def consistent(
    error_ms: np.ndarray,
    draws_ms: np.ndarray,
    scale: Scale,
    allowed: np.ndarray | float = 0.0,
    *,
    by_signal: bool = True,
) -> bool:
    """Return whether the score is within the noise, and with `by_signal` also the error of every single
    signal.

    Args:
        error_ms: mean squares (2, n) of measured minus simulated, pooled.
        draws_ms: the same of each noise draw, (draws, 2, n).
        scale: of the score.
        allowed: mean squares (2, n) by which two right simulations may differ, whatever the noise.
        by_signal: look at each axis and kind by itself too, which finds effects that the score, ruled by
            the noisiest signal, would hide.
    """
    error = normalised(error_ms, scale)
    floors = np.array([normalised(draw + allowed, scale) for draw in draws_ms])
    spread = _DEVIATIONS * floors.std(ddof=1)
    if floors.mean() > HOPELESS:  # a loop that noise blows up would excuse any error
        return False
    if not np.isfinite(error) or error > MARGIN_TOTAL * floors.mean() + spread:
        return False
    if not by_signal:
        return True
    ratios, limits = signal_ratios(error_ms, draws_ms, allowed)
    return bool(np.all(~(ratios > limits)))


def signal_ratios(
    error_ms: np.ndarray, draws_ms: np.ndarray, allowed: np.ndarray | float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return the error of each signal divided by its noise, and the largest ratio that noise alone gives.

    The largest of many signals is larger by chance than one that was picked beforehand: all of them together
    are as unlikely to exceed their limits as one alone to exceed its own (Bonferroni).

    Args:
        error_ms, draws_ms, allowed: as of `consistent`.

    Returns:
        Ratios (2, n), NaN where a signal is not compared, and limits (2, 1), of positions and torques.
    """
    floor = np.where(draws_ms.mean(axis=0) > 0, draws_ms.mean(axis=0), np.nan)
    ratios = np.sqrt(error_ms / (floor + allowed))
    # noise that went round the loop is slow: in a short recording there is little of it to average over.
    # A deviation from a few draws says little by itself, so axes share one.
    scatter = np.sqrt(draws_ms / floor).std(axis=0, ddof=1)
    shared = np.sqrt(np.mean(np.nan_to_num(scatter) ** 2, axis=1, keepdims=True))
    asked = max(int(np.isfinite(ratios).sum()), 1)
    deviations = -ndtri(ndtr(-_DEVIATIONS) / asked)
    return ratios, np.maximum(MARGIN_SIGNAL, 1.1 + deviations * shared)


def outlier_of(
    axes: Sequence[str], error_ms: np.ndarray, draws_ms: np.ndarray, allowed: np.ndarray
) -> Outlier | None:
    """Return the signal that exceeds its largest noise ratio most; None if none does.

    Args:
        axes: names of the axes.
        error_ms, draws_ms, allowed: as of `consistent`.
    """
    ratios, limits = signal_ratios(error_ms, draws_ms, allowed)
    above = np.nan_to_num(ratios / limits)
    kind, axis = (int(k) for k in np.unravel_index(int(above.argmax()), above.shape))
    if above[kind, axis] <= 1.0:
        return None
    ratio = np.sqrt(error_ms[kind, axis] / draws_ms[:, kind, axis].mean())  # as tables show it
    return Outlier(axes[axis], ("position", "torque")[kind], float(ratio), float(limits[kind, 0]))
