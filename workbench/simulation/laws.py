"""Torques that depend on the state, for the runs of one batch: evaluated together, once a step."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco.batch import Batch

from workbench.effects import FrictionTerm, Plant, TorqueTerm, tendon_row


@dataclass
class _Law:
    """One law on one tendon for some runs of a batch.

    `members`: their numbers, ascending; `tendon`: its number; `row`: (nv,), speeds to the tendon's;
    `axis`: of the drive; `parameters`: (members, k).
    """

    members: np.ndarray
    tendon: int
    row: np.ndarray
    axis: int
    law: Callable[..., np.ndarray]
    parameters: np.ndarray


class Laws:
    """All laws of a batch; with none, `present` is False and nothing needs to be done step by step."""

    def __init__(self, plants: Sequence[Plant], batch: Batch, step: float) -> None:
        model, self.step = plants[0].mujoco, step
        self.friction = _gathered([p.chain.friction for p in plants], model)
        self.torques = _gathered([p.chain.torques for p in plants], model)
        self.present = bool(self.friction or self.torques)
        self.before = batch.bind("qvel").copy()
        if self.friction:
            self.loss = batch.expand("tendon_frictionloss")
            self.constant = self.loss.copy()

    def apply(self, position: np.ndarray, speed: np.ndarray, shaft: np.ndarray, force: np.ndarray) -> None:
        """Set friction bounds and add torques for the coming step, of the first runs of the batch.

        Everything is taken at the middle of the step, by extrapolating the speed half a step.

        Args:
            position, speed: of all joints at the start of the step, (count, nv).
            shaft: motor torque on the drives, (count, n).
            force: on the joints, (count, nv); added to.
        """
        count = len(speed)
        middle = 1.5 * speed - 0.5 * self.before[:count]
        self.before[:count] = speed
        for law in self.torques:
            m, live = _live(law, count)
            place = (position[m] + 0.5 * self.step * middle[m]) @ law.row
            torque = law.law(place, middle[m] @ law.row, *law.parameters[live].T)
            force[m] += torque[:, None] * law.row
        if self.friction:
            self.loss[:count] = self.constant[:count]
        for law in self.friction:
            m, live = _live(law, count)
            bound = law.law(middle[m] @ law.row, shaft[m, law.axis], *law.parameters[live].T)
            self.loss[m, law.tendon] += bound


def _live(law: _Law, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Members among the first `count` runs, and which of the law's they are."""
    live = law.members < count
    return law.members[live], live


def _gathered(terms: Sequence[Sequence[FrictionTerm | TorqueTerm]], model: mujoco.MjModel) -> list[_Law]:
    """Terms of all runs as few laws: one each tendon and law (and repetition in a run)."""
    found: dict[tuple[str, Callable[..., np.ndarray], int], list[tuple[int, tuple[float, ...]]]]
    found = defaultdict(list)
    for i, own in enumerate(terms):
        seen: dict[tuple[str, Callable[..., np.ndarray]], int] = defaultdict(int)
        for term in own:
            kind = (term.tendon, term.law)
            found[*kind, seen[kind]].append((i, term.parameters))
            seen[kind] += 1
    return [
        _Law(
            np.array([i for i, _ in entries]),
            model.tendon(tendon).id,
            tendon_row(model, tendon),
            int(tendon.partition(":")[2]),
            law,
            np.array([p for _, p in entries]),
        )
        for (tendon, law, _), entries in found.items()
    ]
