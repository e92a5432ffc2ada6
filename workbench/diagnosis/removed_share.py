"""The share of the excess error that an effect removes: one measure for findings and rankings, in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from workbench.core import EffectKey

from .policy import POLICY

_NONE_TOLERANCE = 1e-12  # squared error above the noise that is none


def removed_share(before: float, after: float, floor: float) -> float:
    """Return the share of the squared error above the noise that an effect removes.

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
    """Return the `removed_share` of each effect from the error that it leaves, largest first."""
    shares = ((key, removed_share(before, after, floor)) for key, after in left)
    return tuple(sorted(shares, key=lambda r: -r[1]))


@dataclass(frozen=True)
class HeldOutFall:
    """The errors of held-out recordings without an effect, with it, and of a perfect model."""

    before: float
    after: float
    floor: float

    @property
    def share(self) -> float | None:
        """Return the `removed_share`; None where the recordings show too little without the effect."""
        before, after, floor = self.before**2, self.after**2, self.floor**2
        return None if before < POLICY.holdout_informative * floor else removed_share(before, after, floor)

    @property
    def line(self) -> str:
        """Return a line that says what share of the held-out errors the effect removes; the errors stand
        beside it.
        """
        if self.share is None:
            times = self.before / self.floor
            return f"held-out recordings cannot test it: their error is only {times:.2f} times the noise"
        return removes(self.share, "held-out recordings")


def removes(share: float, data: str) -> str:
    """Return a `removed_share` as a clause that names the data; a negative share reads as an increase."""
    if share < 0.0:
        return f"adds {-100.0 * share:.1f} % to the squared error above the noise on {data}"
    return f"removes {shown(share)} of the squared error above the noise on {data}"


def shown(share: float) -> str:
    """Return a share as one says it: all where noise alone is left, otherwise percent that never round to
    100.
    """
    if share >= 1.0:
        return "all"
    return "more than 99.9 %" if share >= 0.9995 else f"{100.0 * max(share, 0.0):.1f} %"
