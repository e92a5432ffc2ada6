"""A number in a field of bits: equal steps over a range, both ends included."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, isfinite

from .frame import FrameError


@dataclass(frozen=True)
class Span:
    """Numbers low + raw (high - low) / (2^bits - 1).

    Where low = -high, zero lies between two steps: half a step is the closest.

    Attributes:
        low, high: the ends of the range.
        bits: of the field.
        kept: largest raw numbers that are not used; what they would stand for becomes the step below.
    """

    low: float
    high: float
    bits: int
    kept: int = 0

    def __post_init__(self) -> None:
        if not (isfinite(self.low) and isfinite(self.high) and self.low < self.high):
            raise FrameError(f"no range: {self.low:g} to {self.high:g}")

    @property
    def full(self) -> int:
        """Return the largest raw number."""
        return (1 << self.bits) - 1

    @property
    def step(self) -> float:
        """Return the size of one raw step."""
        return (self.high - self.low) / self.full

    def encode(self, value: float) -> int:
        """Return the raw number closest to `value`.

        Raises:
            FrameError: not a number, infinite, or more than half a step outside the range.
        """
        if not isfinite(value):
            raise FrameError(f"{value} cannot be sent")
        raw = floor((value - self.low) / (self.high - self.low) * self.full + 0.5)
        if not 0 <= raw <= self.full:
            raise FrameError(f"{value:g} is outside {self.low:g} to {self.high:g}")
        return min(raw, self.full - self.kept)

    def clipped(self, value: float) -> int:
        """Return the raw number closest to `value`, the first or last one where it is outside the range."""
        return min(max(round((value - self.low) / self.step), 0), self.full)

    def decode(self, raw: int) -> float:
        """Return the value of a raw number."""
        return self.low + raw * (self.high - self.low) / self.full
