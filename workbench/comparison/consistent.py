"""Whether noise explains an error."""

from __future__ import annotations

import numpy as np

from workbench.core import HOPELESS

# A right model's score scatters by a few per cent: noise levels are known to about 2 %, and a single
# signal's floor from a few draws to about 3 %.
MARGIN_TOTAL = 1.06
_MARGIN_SIGNAL = 1.3


def consistent(
    error_ms: np.ndarray,
    draws_ms: np.ndarray,
    error: float,
    floors: np.ndarray,
    allowed: np.ndarray | float = 0.0,
    *,
    by_signal: bool = True,
) -> bool:
    """Whether the score is no larger than noise makes it, and (`by_signal`) no single signal's error either.

    Args:
        error_ms: mean squares (2, n) of measured minus simulated, pooled.
        draws_ms: the same of each noise draw, (draws, 2, n).
        error: the score.
        floors: the score of each noise draw, (draws,).
        allowed: mean squares (2, n) of a signal that mean nothing, whatever its noise.
        by_signal: look at each axis and kind by itself too, which finds effects that the score, ruled by
            the noisiest signal, would hide.
    """
    spread = 3.0 * floors.std(ddof=1)
    if floors.mean() > HOPELESS:  # a loop that noise blows up would excuse any error
        return False
    if not np.isfinite(error) or error > MARGIN_TOTAL * floors.mean() + spread:
        return False
    floor = np.where(draws_ms.mean(axis=0) > 0, draws_ms.mean(axis=0), np.nan)
    # noise that went round the loop is slow: in a short recording there is little of it to average over.
    # A deviation from a few draws says little by itself, so axes share one.
    scatter = np.sqrt(draws_ms / floor).std(axis=0, ddof=1)
    shared = np.sqrt(np.mean(np.nan_to_num(scatter) ** 2, axis=1, keepdims=True))
    limit = np.maximum(_MARGIN_SIGNAL, 1.1 + 3.0 * shared)
    return not by_signal or bool(np.all(~(np.sqrt(error_ms / (floor + allowed)) > limit)))
