"""The share of the excess error that an effect removes: one measure for findings and rankings."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.core import EffectKey

_NONE_TOLERANCE = 1e-12  # squared error above the noise that is none


def removed_share(before: float, after: float, floor: float) -> float:
    """Share of the squared error above the noise that is gone.

    Args:
        before: weighted mean square of the error of the model without the effect.
        after: the same with it.
        floor: the same of a perfect model: noise, and what right simulations differ by.

    Returns:
        1 where noise alone is left, 0 where nothing changed; negative where the error grew, and a little over
        1 where what is left lies below the floor.
    """
    return (before - after) / max(before - floor, _NONE_TOLERANCE)


def removed_shares(
    before: float, left: Sequence[tuple[EffectKey, float]], floor: float
) -> tuple[tuple[EffectKey, float], ...]:
    """`removed_share` of effects by what each leaves, best first."""
    shares = ((key, removed_share(before, after, floor)) for key, after in left)
    return tuple(sorted(shares, key=lambda r: -r[1]))
