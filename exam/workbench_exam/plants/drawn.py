"""A case before it is recorded, the machine that it is of, and the motion that judges it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from .plant import Plant, Ticks, play, stranger, with_effect

JUDGE, JUDGED = 3, 6.0  # number of the motion that judges, and how long it is [s]


@dataclass(frozen=True)
class Item:
    """One effect or stranger: name, drive, values; and how far its absence shows, over the noise."""

    effect: str
    place: str | None
    values: Mapping[str, float]
    shows: float = 0.0


@dataclass(frozen=True)
class Drawn:
    """A case before it is recorded.

    Attributes:
        kind: of `KINDS`. family: of `MACHINES`. way: of `WAYS` or ``positions_alone``. seed: of all draws.
        file: what the model's file has.
        hidden: effects of the vocabulary. strangers: what it does not have.
        odd: number of the recording that is unlike the others, its torque's unit, and its load at the tip
            [kg].
    """

    kind: str
    family: str
    way: str
    seed: int
    file: Plant
    hidden: tuple[Item, ...] = ()
    strangers: tuple[Item, ...] = ()
    odd: tuple[int, float, float] | None = None
    tick: float = field(default=2e-3)
    every: int = 1


def true_plant(drawn: Drawn) -> Plant:
    """The machine that is recorded."""
    plant = drawn.file
    for each in drawn.hidden:
        plant = with_effect(plant, each.effect, each.place, each.values)
    for each in drawn.strangers:
        plant = stranger(plant, each.effect, each.place or "", each.values)
    return plant


def judged(plant: Plant, drawn: Drawn, noisy: bool = False) -> Ticks:
    """The motion that judges, which no solver sees."""
    encoder = 2 * np.pi / 2**12 if drawn.way == "coarse" else None
    return play(plant, drawn.seed, JUDGE, JUDGED, drawn.tick, noisy=noisy, encoder=encoder)


def apart(one: Ticks, other: Ticks) -> float:
    """Root mean square over drives, angle and torque of their difference over the signal's deviation."""
    parts = []
    for name in ("angle", "torque"):
        a, b = getattr(one, name), getattr(other, name)
        spread = a.std(axis=0)
        moves = spread > 1e-9
        parts.append(((a - b).std(axis=0) ** 2 + (a - b).mean(axis=0) ** 2)[moves] / spread[moves] ** 2)
    return float(np.sqrt(np.mean(np.concatenate(parts))))
