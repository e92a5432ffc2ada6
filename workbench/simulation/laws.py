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


@dataclass
class _Spring:
    """Hysteresis on one tendon for some runs: state z (members,) at the places where the axes were last."""

    members: np.ndarray
    tendon: int
    row: np.ndarray
    torque: np.ndarray
    ratio: np.ndarray
    place: np.ndarray
    state: np.ndarray


class Laws:
    """All laws of a batch; with none, `present` is False and nothing needs to be done step by step."""

    def __init__(self, plants: Sequence[Plant], batch: Batch, step: float) -> None:
        model, self.step = plants[0].mujoco, step
        self.friction = _gathered([p.chain.friction for p in plants], model)
        self.torques = _gathered([p.chain.torques for p in plants], model)
        self.present = any(p.chain.follows_state for p in plants)
        self.before = batch.bind("qvel").copy()
        self.springs = _springs(plants, batch)
        if self.springs:
            self.stiffness, self.rest = batch.expand("tendon_stiffness"), batch.expand("tendon_lengthspring")
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
        for spring in self.springs:
            self._bend(spring, position, middle, force)
        if self.friction:
            self.loss[:count] = self.constant[:count]
        for law in self.friction:
            m, live = _live(law, count)
            bound = law.law(middle[m] @ law.row, shaft[m, law.axis], *law.parameters[live].T)
            self.loss[m, law.tendon] += bound

    def _bend(self, spring: _Spring, position: np.ndarray, middle: np.ndarray, force: np.ndarray) -> None:
        """Hysteresis as a force and a spring about where the axis is, right at the end of the step too."""
        live = spring.members < len(position)
        m, ratio = spring.members[live], spring.ratio[live]
        place = position[m] @ spring.row
        spring.state[live] = _wound(spring.state[live], place - spring.place[live], ratio)
        spring.place[live] = place
        state, level = spring.state[live], spring.torque[live]
        coming = self.step * (middle[m] @ spring.row)
        way = np.where(coming == 0.0, 1e-12, coming)
        self.stiffness[m, spring.tendon] = level * (_wound(state, way, ratio) - state) / way
        self.rest[m, spring.tendon] = place[:, None]
        force[m] -= (level * state)[:, None] * spring.row


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


def _springs(plants: Sequence[Plant], batch: Batch) -> list[_Spring]:
    """The hysteresis of all runs, one entry a tendon; relaxed where the runs start."""
    model, found = plants[0].mujoco, []
    for name in dict.fromkeys(t.spring for p in plants for t in p.chain.hysteresis):
        own = [(i, t) for i, p in enumerate(plants) for t in p.chain.hysteresis if t.spring == name]
        members, row = np.array([i for i, _ in own]), tendon_row(model, name)
        torque = np.array([max(t.torque, 1e-12) for _, t in own])
        ratio = np.array([t.stiffness for _, t in own]) / torque
        place = batch.bind("qpos")[members] @ row
        tendon = model.tendon(name).id
        found.append(_Spring(members, tendon, row, torque, ratio, place, np.zeros(len(own))))
    return found


def _wound(state: np.ndarray, moved: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """Dahl's state after a way without a reversal, exact."""
    side = np.sign(moved)
    return side - (side - state) * np.exp(-ratio * np.abs(moved))
