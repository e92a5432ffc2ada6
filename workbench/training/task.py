"""A task of a policy: observations, commands, rewards and scores."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from .draws import Draws
from .machine import Machine
from .randomisation import Randomisation
from .situation import POLICY_S, Array
from .terms import Observation, Reward


class Logged(Protocol):
    """The log of an evaluation, one row per control step since the policy started."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints."""
        ...

    def get(self, name: str) -> np.ndarray:
        """Return a signal (N, k): joints, goal; for a base also base_angular, base_linear, base_gravity,
        ground_force.
        """
        ...


@dataclass(frozen=True)
class Task:
    """A task of a policy.

    Attributes:
        name: on the command line.
        about: in a sentence.
        machine: ``leg`` or ``quadruped``.
        episode_s: length of an episode [s].
        action_scale: joint angle of an action of 1 [rad].
        observations: what the policy sees, in the order of its input.
        privileged: what the critic sees beside that.
        rewards: terms of the reward.
        command: draws the commands of episodes, ``command(draws, worlds, machine) -> (W, c)``.
        randomisation: of the leg's links, as in the paper's table (name in `LEG_RANDOMISATION`).
        hidden: widths of the policy's hidden layers.
        iterations: of PPO, as the paper had them.
        commands: lowest and highest forward, sideward and turning speed [m/s, m/s, rad/s]; None without one.
        posture: joint angles from which actions count, in place of the machine's [rad].
        source: the task file that it was read from, as text; None for a shipped task.
        suffix: of that file, ``.toml`` or ``.py``.
        numbers: of a command, by the number of joints; 1 if left out.
        trial: command of an evaluation, ``trial(machine) -> (1, c)``; drawn where it is left out.
        goal: joint angles and speeds to follow, ``goal(xp, command, time) -> (W, n), (W, n)`` [rad, rad/s];
            None where the task is no motion of the joints.
        scores: what an evaluation is judged by, of its log; nothing where it is left out.
        trunk_mass: lowest and highest addition to the mass of a trunk, in place of those of `Randomisation`
            [kg].
    """

    name: str
    about: str
    machine: str
    episode_s: float
    action_scale: float
    observations: tuple[Observation, ...]
    privileged: tuple[Observation, ...]
    rewards: tuple[Reward, ...]
    command: Callable[[Draws, int, Machine], Array]
    randomisation: str
    hidden: tuple[int, ...]
    iterations: int
    commands: tuple[tuple[float, float], ...] | None = None
    posture: tuple[float, ...] | None = None
    source: str | None = None
    suffix: str = ".toml"
    numbers: Callable[[int], int] = lambda joints: 1
    trial: Callable[[Machine], Array] | None = None
    goal: Callable[[Any, Array, Array], tuple[Array, Array]] | None = None
    scores: Callable[[Logged], dict[str, float]] = lambda log: {}
    trunk_mass: tuple[float, float] | None = None

    @property
    def episode_steps(self) -> int:
        """Return the number of policy steps in an episode."""
        return round(self.episode_s / POLICY_S)

    def differences(self, legs: str | None = None) -> Randomisation:
        """Return what its worlds differ in; `legs` in place of the task's `randomisation`."""
        drawn = Randomisation(legs=legs or self.randomisation)
        return drawn if self.trunk_mass is None else replace(drawn, base_mass=self.trunk_mass)
