"""A task in many parallel worlds: takes actions, returns observations, rewards and ends of episodes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .control import action_target, drive_torque
from .draws import Draws
from .machine import POLICY_STEPS, Machine
from .randomisation import Randomisation
from .situation import POLICY_S, Array, Constants, Situation, base_state
from .task import Task
from .terms import CONTACT_N, Observation
from .worlds import Worlds

ACTION_LIMIT = 10.0  # of an action; far outside what a policy asks for
STEEPEST = 0.6  # cosine of the tilt beyond which it has fallen


@dataclass
class Step:
    """Result of one policy step, W worlds.

    Attributes:
        observation: what the policy sees next (W, k).
        privileged: what the critic sees beside it (W, p).
        reward: (W,).
        ended: episodes that ended, (W,) bool; their next observation is of a new episode.
        timed_out: those that ended by time alone, (W,) bool.
        terms: mean of each weighted term of the reward per second, by name.
    """

    observation: Array
    privileged: Array
    reward: Array
    ended: Array
    timed_out: Array
    terms: dict[str, Array]


class Environment:
    """W worlds of a task.

    Args:
        task: what is to be done.
        machine: with what.
        worlds: the engine.
        count: number of worlds W.
        randomisation: pushes; what differs between the worlds is in the engine already.
        seed: of commands, first states, noise and pushes.
        noise: whether the policy's observations carry the sensors' errors.
        keep_final: whether `final` has the last observations (W, k) of episodes that a step ended.
    """

    def __init__(
        self,
        task: Task,
        machine: Machine,
        worlds: Worlds,
        count: int,
        randomisation: Randomisation | None = None,
        seed: int = 0,
        noise: bool = True,
        keep_final: bool = False,
    ) -> None:
        self.keep_final, self.final = keep_final, None
        self.task, self.machine, self.worlds, self.count, self.noise = task, machine, worlds, count, noise
        self.push = randomisation or Randomisation()
        self.xp = xp = worlds.xp
        self.draws = Draws(xp, seed, worlds.qpos)
        self.constants = Constants(machine, xp, worlds.qpos)
        zero = xp.zeros_like(worlds.ctrl)
        self.action, self.last_action, self.torque = zero, zero, zero
        self.waiting = [zero] * machine.delay_steps  # torques on their way to the drives, oldest first
        self.steps = xp.zeros_like(worlds.qpos[:, 0])
        self.air = xp.zeros_like(zero[:, :4])
        self.landed = xp.zeros_like(self.air)
        self.command = task.command(self.draws, count, machine)
        self._begin(self.steps == 0.0)

    def spread(self) -> None:
        """Set every world to a random time of its episode, so that they do not all end together."""
        unit = self.draws.uniform((0.0,), (1.0,), (self.count, 1))[:, 0]
        self.steps = self.xp.floor(unit * self.task.episode_steps)

    def step(self, action: Array) -> Step:
        """Run one policy step: the action is held over its control steps.

        Args:
            action: (W, n); ``posture + action_scale * action`` are the angles that the joints' loop gets.
        """
        xp, c = self.xp, self.constants
        self.last_action, self.action = self.action, xp.clip(action, -ACTION_LIMIT, ACTION_LIMIT)
        target = action_target(c, self.action, self.task.action_scale)
        worlds = self.worlds
        for _ in range(POLICY_STEPS):
            asked = drive_torque(c, target, *c.measured(worlds.qpos, worlds.qvel))
            self.waiting.append(asked)
            self.torque = self.waiting.pop(0)
            worlds.ctrl[:] = self.torque
            worlds.step()
        self.steps = self.steps + 1.0
        self._feet()
        now = self.situation()
        finite = xp.isfinite(xp.sum(now.position, -1) + xp.sum(now.velocity, -1))
        now.fallen = ~finite | self._has_fallen(now)
        terms = {term.name: term.weight * term.function(now) for term in self.task.rewards}
        reward = POLICY_S * sum(terms.values())
        reward = xp.where(finite, reward, xp.zeros_like(reward))
        timed_out = (self.steps >= self.task.episode_steps) & ~now.fallen
        ended = timed_out | now.fallen
        means = {name: xp.mean(xp.where(finite, value, 0.0 * reward)) for name, value in terms.items()}
        self._push()
        if self.keep_final:
            self.final = self._stack(now, self.task.observations, self.noise)
        self._begin(ended)
        observation, privileged = self.observe()
        return Step(observation, privileged, reward, ended, timed_out, means)

    def observe(self) -> tuple[Array, Array]:
        """Return the observations of the policy (W, k) and the additional ones of the critic (W, p)."""
        now = self.situation()
        seen = self._stack(now, self.task.observations, self.noise)
        return seen, self._stack(now, self.task.privileged, False)

    def situation(self) -> Situation:
        """Return the state of all worlds for the terms of the task."""
        c, worlds = self.constants, self.worlds
        position, velocity = c.measured(worlds.qpos, worlds.qvel)
        now = Situation(
            xp=self.xp,
            machine=c,
            position=position,
            velocity=velocity,
            torque=self.torque,
            action=self.action,
            last_action=self.last_action,
            elapsed=self.steps * POLICY_S,
            command=self.command,
        )
        if self.machine.floating:
            now.height = worlds.qpos[:, 2]
            now.gravity, now.linear, now.angular = base_state(self.xp, worlds.qpos, worlds.qvel)
            now.foot_force, now.foot_speed = worlds.sensordata[:, c.touch], worlds.sensordata[:, c.speed]
            now.air_time, now.landed = self.air, self.landed
        return now

    def state(self) -> dict[str, Any]:
        """Return everything on which the next step depends, as arrays."""
        return {
            "worlds": self.worlds.state(),
            "draws": self.draws.state(),
            "waiting": list(self.waiting),
            **{name: getattr(self, name) for name in _CARRIED},
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Continue from a `state`."""
        self.worlds.restore(state["worlds"])
        self.draws.restore(state["draws"])
        self.waiting = [self._own(x) for x in state["waiting"]]
        for name in _CARRIED:
            setattr(self, name, self._own(state[name]))

    def _own(self, value: Any) -> Array:
        """A saved array in the worlds' library, precision and device."""
        like = self.worlds.qpos
        if self.xp is np:
            return np.array(value, like.dtype)
        return self.xp.as_tensor(value, dtype=like.dtype, device=like.device).clone()

    def _stack(self, now: Situation, table: tuple[Observation, ...], noise: bool) -> Array:
        if not table:
            return now.position[:, :0]
        parts = []
        for entry in table:
            value = entry.function(now)
            if noise and entry.noise:
                value = value + self.draws.uniform((-entry.noise,), (entry.noise,), tuple(value.shape))
            parts.append(entry.scale * value)
        return self.xp.concatenate(parts, -1)

    def _has_fallen(self, now: Situation) -> Array:
        if not self.machine.floating:
            return self.xp.zeros_like(self.steps) > 1.0
        return (now.height < self.machine.lowest) | (-now.gravity[:, 2] < STEEPEST)

    def _feet(self) -> None:
        """Count how long each foot is off the ground."""
        if not self.machine.floating:
            return
        xp = self.xp
        loaded = self.worlds.sensordata[:, self.constants.touch] > CONTACT_N
        self.landed = xp.where(loaded, self.air, xp.zeros_like(self.air))
        self.air = xp.where(loaded, xp.zeros_like(self.air), self.air + POLICY_S)

    def _push(self) -> None:
        """Now and then the base is knocked."""
        if not self.machine.floating or not self.push.push:
            return
        unit = self.draws.uniform((0.0,), (1.0,), (self.count, 1))
        size = self.draws.uniform((-self.push.push,), (self.push.push,), (self.count, 2))
        hit = unit < POLICY_S / self.push.push_every_s
        self.worlds.qvel[:, :2] += self.xp.where(hit, size, self.xp.zeros_like(size))

    def _begin(self, where: Array) -> None:
        """Start new episodes in the worlds that `where` marks."""
        xp, c, n, w = self.xp, self.constants, self.machine.size, self.count
        draw = self.draws.uniform
        qpos, qvel = xp.zeros_like(self.worlds.qpos), xp.zeros_like(self.worlds.qvel)
        qpos[:, c.places] = c.posture + draw((-0.1,), (0.1,), (w, n))
        qvel[:, c.dofs] = draw((-0.2,), (0.2,), (w, n))
        if c.read is not None:  # springs at rest, gaps in their middle
            qpos[:, c.rotor_places] = qpos[:, c.places] @ c.follow
            qvel[:, c.rotor_dofs] = qvel[:, c.dofs] @ c.follow
        if self.machine.floating:
            qpos[:, 2] = self.machine.height + draw((0.0,), (0.02,), (w, 1))[:, 0]
            half = 0.5 * draw((-0.05, -0.05, -3.14), (0.05, 0.05, 3.14), (w, 3))
            qpos[:, 3:7] = _quaternion(xp, half)
            qvel[:, :6] = draw((-0.2,), (0.2,), (w, 6))
        command = self.task.command(self.draws, w, self.machine)
        column = where[:, None]
        self.worlds.put(where, qpos, qvel)
        self.command = xp.where(column, command, self.command)
        for name in ("action", "last_action", "torque", "air", "landed"):
            value = getattr(self, name)
            setattr(self, name, xp.where(column, xp.zeros_like(value), value))
        self.waiting = [xp.where(column, xp.zeros_like(x), x) for x in self.waiting]
        self.steps = xp.where(where, xp.zeros_like(self.steps), self.steps)


_CARRIED = "action", "last_action", "torque", "steps", "air", "landed", "command"


def _quaternion(xp: Any, half: Array) -> Array:
    """Of roll, pitch and yaw, given by half angles (W, 3)."""
    (cr, cp, cy), (sr, sp, sy) = ([f(half[:, i]) for i in range(3)] for f in (xp.cos, xp.sin))
    return xp.stack(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ],
        -1,
    )
