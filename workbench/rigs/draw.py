"""Draws hidden effects: which, where, how large."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from workbench.core import InputError

from .hidden import HiddenEffect
from .magnitudes import DEMO_EFFECTS, LARGEST, SMALLEST, SPAN, Seat
from .shapes import hidden_effect


def draw_hidden(seed: int, effects: Collection[str] = DEMO_EFFECTS) -> HiddenEffect:
    """Return one effect with a magnitude log-uniform between clearly visible and `SPAN` times that.

    Every effect is as likely as any other, then every place where it can sit.

    Args:
        seed: draws all of it.
        effects: names to draw from; `DRAWN_EFFECTS` are all that there are.

    Raises:
        InputError: an effect that is never drawn.
    """
    generator = np.random.default_rng([seed, 23])
    return draw_from(seats_of(effects), generator)


def magnitude_range(seat: Seat) -> tuple[float, float]:
    """Return smallest and largest drawn magnitude at `seat`, in the unit of `hidden_effect`."""
    low = SMALLEST[seat]
    return low, max(low, min(SPAN * low, LARGEST.get(seat[0], np.inf)))


def seats_of(effects: Collection[str]) -> list[Seat]:
    """Return every seat of these effects.

    Raises:
        InputError: there is none of one of them.
    """
    for name in set(effects) - {effect for effect, _, _ in SMALLEST}:
        raise InputError(f"'{name}' is never drawn", remedy="see workbench.rigs.DRAWN_EFFECTS")
    return [seat for seat in SMALLEST if seat[0] in effects]


def draw_from(seats: Sequence[Seat], generator: np.random.Generator) -> HiddenEffect:
    """Return one effect at one of these seats, as `draw_hidden` draws it."""
    names = sorted({effect for effect, _, _ in seats})
    chosen = names[generator.integers(len(names))]
    own = [seat for seat in seats if seat[0] == chosen]
    seat = own[generator.integers(len(own))]
    low, high = magnitude_range(seat)
    return hidden_effect(seat, float(np.exp(generator.uniform(np.log(low), np.log(high)))), generator)
