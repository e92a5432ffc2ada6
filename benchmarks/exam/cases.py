"""The cases: what is hidden, how large, and how it is recorded; the same for the same seed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from workbench.rigs import DRAWN_EFFECTS, HiddenEffect, hidden_effect
from workbench.rigs.draw import magnitude_range
from workbench.rigs.magnitudes import SMALLEST, Seat

from .draw import draw_several
from .outsiders import OUTSIDE, draw_outsider
from .second.hidden import Hidden

if TYPE_CHECKING:
    from .field.plant import Field

KINDS = ("single", "pair", "triple", "clean", "outsider")
#: Magnitudes as a share of the way, in logarithms, from the smallest that is drawn to the largest. The
#: smallest doubles the error over its noise; below it an effect is barely visible, and need not be found.
SIZES = {"faint": (-0.4, -0.05), "small": (0.0, 0.25), "middle": (0.4, 0.6), "gross": (0.8, 1.0)}
_TWICE = (("middle", "faint"), ("gross", "small"), ("small", "middle"))
#: Ways to record; `exam.record` says what each is.
ODD = (
    "no_holdout",
    "one_chirp",
    "slow_only",
    "no_velocity",
    "no_torque",
    "jitter",
    "coarse",
    "noisy",
    "every_third",
    "fast_loop",
    "short",
    "long",
    "revealing",
)
_COUNTS = {"pair": 34, "triple": 17, "plain": 12, "outsiders": 3}


@dataclass(frozen=True)
class Case:
    """One question.

    Attributes:
        name: says all of it, with the exam's seed.
        kind: of `KINDS`.
        seed: of the noise and the validation motion.
        hidden: what the rig hides.
        size: of `SIZES`, or ``"drawn"``.
        recorded: ``"usual"`` or one of `ODD`.
        rig: which simulator records it, the virtual leg, the second one, or that of the `field`.
        field: the machine and how it is recorded, of a case of the field.
    """

    name: str
    kind: str
    seed: int
    hidden: tuple[HiddenEffect | Hidden, ...]
    size: str = "drawn"
    recorded: str = "usual"
    rig: Literal["virtual", "second", "field"] = "virtual"
    field: Field | None = None


def all_cases(seed: int = 0) -> list[Case]:
    """Every case of an exam, in an order whose every beginning is a fair sample of kinds and effects."""
    groups = [_singles(seed), _several(seed, "pair", 2), _several(seed, "triple", 3)]
    groups += [_clean(seed), _outsiders(seed)]
    return interleaved(groups)


def interleaved(groups: Sequence[Sequence[Case]]) -> list[Case]:
    """Merged so that each group is spread evenly over the whole."""
    placed = [((i + 0.5) / len(g), k, case) for k, g in enumerate(groups) for i, case in enumerate(g)]
    return [case for _, _, case in sorted(placed, key=lambda p: p[:2])]


def _singles(seed: int) -> list[Case]:
    """Every effect at every place where the rig hides it, at two sizes; each effect once before any twice."""
    generator = np.random.default_rng([seed, 101])
    by_effect: dict[str, list[tuple[Seat, str]]] = defaultdict(list)
    for turn in range(2):
        for index, seat in enumerate(SMALLEST):
            by_effect[seat[0]].append((seat, _TWICE[(index + seed) % len(_TWICE)][turn]))
    rounds: dict[int, list[Case]] = defaultdict(list)
    for wanted in by_effect.values():
        first, second = wanted[: len(wanted) // 2], wanted[len(wanted) // 2 :]
        order = [*generator.permutation(len(first)), *(len(first) + generator.permutation(len(second)))]
        for turn, chosen in enumerate(order):
            seat, size = wanted[chosen]
            number = 1000 * seed + 10 * list(SMALLEST).index(seat) + list(SIZES).index(size)
            place = "-".join(part for part in seat if part)
            case = Case(
                f"s{seed}-single-{place}-{size}", "single", number, (_sized(seat, size, number),), size
            )
            rounds[turn].append(case)
    return [cases[i] for turn, cases in sorted(rounds.items()) for i in generator.permutation(len(cases))]


def _sized(seat: Seat, size: str, seed: int) -> HiddenEffect:
    generator = np.random.default_rng([seed, 103])
    low, high = magnitude_range(seat)
    way = generator.uniform(*SIZES[size])
    factor = (max(high, 1.5 * low) / low) ** way
    return hidden_effect(seat, float(min(low * factor, high)), generator)


def _several(seed: int, kind: str, count: int) -> list[Case]:
    first = 5000 * (seed + 1) + 1000 * count
    numbers = range(first, first + _COUNTS[kind])
    return [Case(f"s{seed}-{kind}-{n}", kind, n, draw_several(n, count, DRAWN_EFFECTS)) for n in numbers]


def _clean(seed: int) -> list[Case]:
    first = 5000 * (seed + 1) + 100
    ways = ["usual"] * _COUNTS["plain"]
    ways = [way for pair in zip(ways, ODD, strict=False) for way in pair] + [*ODD[len(ways) :]]
    return [
        Case(f"s{seed}-clean-{first + i}-{way}", "clean", first + i, (), "none", way)
        for i, way in enumerate(ways)
    ]


def _outsiders(seed: int) -> list[Case]:
    first = 5000 * (seed + 1) + 300
    names = [*OUTSIDE] * _COUNTS["outsiders"]
    return [
        Case(f"s{seed}-outsider-{name}-{first + i}", "outsider", first + i, (draw_outsider(name, first + i),))
        for i, name in enumerate(names)
    ]
