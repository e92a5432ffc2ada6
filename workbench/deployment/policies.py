"""Controllers that follow a trajectory: a policy of a bundle, or no network at all."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np

from workbench.bundle import PolicyBundle
from workbench.can import CanConfig
from workbench.core import InputError

from .base import BaseMotion
from .command import Command
from .controller import Target
from .joints import Joints
from .observe import Reach, Sight, check_layout, observe
from .trained import check_bounds

#: Observation (k,) in, action (n,) out.
Act = Callable[[np.ndarray], np.ndarray]
_SAME = 1e-6


class Tracker:
    """A controller that follows joint trajectories without a network; until the loop runs, it waits."""

    def __init__(self, goal: Reach) -> None:
        self._goal, self._begun = goal, np.inf
        self._zero = np.zeros(len(goal.middle))

    def target(
        self, now: float, phase: str, position: np.ndarray, velocity: np.ndarray, base: BaseMotion
    ) -> Target:
        """Return the reference of this tick."""
        self._begun = min(self._begun, now) if phase == "run" else np.inf
        time = max(0.0, now - self._begun) if phase == "run" else 0.0
        return Target(self._goal.position(time), self._zero, now)


class PolicyController:
    """A controller with a policy: it computes an action every few ticks and holds it in between.

    Args:
        bundle: what its input and output mean.
        act: the network.
        goal: what it is to follow.
        every: ticks from one action to the next.
        period: of the loop [s].
        hold: how long the posture is held first [s].
        command: the velocity that it is asked for; None for none.
    """

    def __init__(
        self, bundle: PolicyBundle, act: Act, goal: Reach, every: int, period: float, hold: float = 0.0,
        command: Command | None = None,
    ) -> None:  # fmt: skip
        self._bundle, self._act, self._goal, self._hold = bundle, act, goal, hold
        self._command = command or Command()
        self._step, self._period, self._every = every * period, period, every
        self._posture = bundle.control.posture
        self._zero = np.zeros(len(self._posture))
        self._begun, self._due, self._made = np.inf, 0, 0.0
        self._action = self._zero

    def rehearse(self) -> np.ndarray:
        """Call the network once (n,), without any effect."""
        return self._act(np.zeros(sum(entry.size for entry in self._bundle.observations)))

    def target(
        self, now: float, phase: str, position: np.ndarray, velocity: np.ndarray, base: BaseMotion
    ) -> Target:
        """Return the reference of this tick; until the loop runs, and while it holds, the posture."""
        if phase != "run":
            self._begun, self._due, self._action = np.inf, 0, self._zero
            self._command.stand()
            return Target(self._posture, self._zero, now)
        self._begun = min(self._begun, now + self._hold)
        if now < self._begun:
            return Target(self._posture, self._zero, now)
        tick = round((now - self._begun) / self._period)
        if tick >= self._due:
            time = tick * self._period
            sight = Sight(
                position, velocity, self._posture, self._action, self._goal, time, self._step, base.angular,
                base.gravity, self._command.advance(self._step),
            )  # fmt: skip
            self._action = self._act(observe(self._bundle.observations, sight))
            self._made, self._due = now, (tick // self._every + 1) * self._every
        scale = self._bundle.control.action_scale
        return Target(self._posture + scale * self._action, self._zero, self._made)


def check_bundle(bundle: PolicyBundle, config: CanConfig, joints: Joints) -> None:
    """Refuse a bundle that does not fit this robot and this loop.

    Raises:
        InputError: layout, machine, transmission, gains, rates or delay differ, or the robot may do less than
            the policy counts on; names the first that does.
    """
    own, loop, n = bundle.control, config.loop, len(config.motor)
    if len(own.joints) != n:
        problem = f"a policy of {len(own.joints)} joints for {n} motors"
        raise InputError(problem, file=bundle.source, remedy="deploy it on the robot it was trained for")
    check_layout(bundle.observations, n, config)
    if sorted(own.joints) == sorted(joints.names) and own.joints != joints.names:
        raise InputError(
            f"the policy's joints are {', '.join(own.joints)}, in this order", file=config.source,
            column="motor", remedy="name the motors in the order of the policy's joints",
        )  # fmt: skip
    kp, kd = config.gains()
    inside = 0.5 * (own.joint_limits[:, 0] + own.joint_limits[:, 1]), own.posture
    theirs = [q @ own.transmission.T if own.map is None else own.map.drives(q) for q in inside]
    wanted = (
        *(
            ()
            if own.map or joints.maps
            else (("transmission", own.transmission, joints.matrix, "mechanism"),)
        ),
        ("drives' positions", theirs, [joints.axes(q) for q in inside], "mechanism"),
        ("kp", own.kp, np.array(kp), "loop.kp"),
        ("kd", own.kd, np.array(kd), "loop.kd"),
        ("control period", own.control_period_s, loop.period_s, "loop.period_s"),
        ("policy period", own.policy_period_s, loop.period_s * loop.policy_every, "loop.policy_every"),
        # the loop makes one step, and the drives make none
        ("delay in steps", own.delay_steps, 1, "loop"),
    )
    for name, theirs, ours, key in wanted:
        if np.shape(theirs) != np.shape(ours) or not np.allclose(theirs, ours, rtol=0.0, atol=_SAME):
            problem = (
                f"the policy was trained with {name} {_short(theirs)}, the configuration has {_short(ours)}"
            )
            remedy = "change it, or train for it"
            if key == "loop":
                remedy = f"give the model delay_s = {loop.period_s:g}, which a bus adds, and train again"
            raise InputError(problem, file=config.source, column=key, remedy=remedy)
    if loop.pd != "host":
        raise InputError(
            "the policy was trained with the joints' PD on the host", file=config.source, column="loop.pd",
            remedy='write pd = "host"',
        )  # fmt: skip
    machine = hashlib.sha256(bundle.machine.encode()).hexdigest()
    if not config.machine or not machine.startswith(config.machine):
        said = f"says {config.machine}" if config.machine else "names none"
        raise InputError(
            f"the policy was trained for machine {machine[:16]}, the configuration {said}",
            file=config.source, column="machine",
            remedy=f'if this robot is that machine, write machine = "{machine[:16]}"',
        )  # fmt: skip
    check_bounds(bundle, config)


def reach_between(low: np.ndarray, high: np.ndarray, start: np.ndarray, seed: int) -> Reach:
    """Return a slow trajectory around a posture (n,): up to 0.25 rad and 1 Hz, inside limits (n,) [rad]."""
    generator = np.random.default_rng([seed, 41])
    room = np.minimum(start - low, high - start)
    amplitude = np.minimum(generator.uniform(0.1, 0.25, len(start)), 0.4 * np.maximum(room, 0.0))
    return Reach(start, amplitude, 2 * np.pi * generator.uniform(0.3, 1.0, len(start)), np.zeros(len(start)))


def _short(value: object) -> str:
    return " ".join(np.array2string(np.asarray(value), precision=4, separator=", ").split())
