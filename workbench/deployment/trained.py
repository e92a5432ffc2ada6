"""Limits within which a policy was trained, and which a run therefore keeps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import acos

import numpy as np

from workbench.bundle import PolicyBundle
from workbench.can import CanConfig
from workbench.core import InputError

from .limits import Limits
from .observe import OF_THE_BASE

TILT = acos(0.6)  # rad; bundles that do not say it were trained in worlds that end there
#: Lowest and highest forward, sideward and turning speed [m/s, m/s, rad/s], of tasks whose bundles say none.
COMMANDS = {"circular": ((-0.6, 1.2), (-0.3, 0.3), (-1.0, 1.0))}
_SAME = 1e-6


@dataclass(frozen=True, eq=False)
class Trained:
    """Limits of the training of a policy.

    Attributes:
        torque: of each drive (n,) [N m].
        velocity: of each drive [rad/s]; infinite where it is not said.
        tilt: of the base against gravity, at which an episode ended [rad]; infinite without a base.
        commands: lowest and highest (3, 2) of what it was asked for [m/s, m/s, rad/s]; None where it looks at
            no command, or nobody says.
        looks: whether it looks at a command at all.
    """

    torque: np.ndarray
    velocity: float
    tilt: float
    commands: np.ndarray | None
    looks: bool

    def limits(self, limits: Limits) -> Limits:
        """Return the limits of a configuration, no wider than those of the training."""
        return replace(
            limits,
            torque=np.minimum(limits.torque, self.torque),
            velocity=np.minimum(limits.velocity, self.velocity),
            tilt=min(limits.tilt, self.tilt),
        )

    def clipped(self, twist: np.ndarray) -> tuple[np.ndarray, str]:
        """Return a command (3,) clipped to the training, and a line that says what changed; else empty."""
        if not twist.any():
            return twist, ""
        if not self.looks:
            return np.zeros(3), "the policy does not use a commanded velocity: it is left out"
        if self.commands is None:
            return twist, "the bundle does not say within which velocities it was trained"
        within = np.clip(twist, *self.commands.T)
        if np.array_equal(within, twist):
            return twist, ""
        return (
            within,
            f"the command {_three(twist)} is clipped to {_three(within)}, the range of the training",
        )


def trained_of(bundle: PolicyBundle) -> Trained:
    """Return the limits that a bundle states; for bundles from before they were stated, those of its task."""
    own = bundle.control
    names = {entry.name for entry in bundle.observations}
    looks = "velocity_command" in names
    commands = own.command_range if own.command_range is not None else COMMANDS.get(bundle.task)
    feels = bool(names & set(OF_THE_BASE))
    return Trained(
        torque=own.torque_limit,
        velocity=own.velocity_limit or np.inf,
        tilt=(own.tilt_limit or TILT) if feels else np.inf,
        commands=None if commands is None or not looks else np.array(commands, float),
        looks=looks,
    )


def check_bounds(bundle: PolicyBundle, config: CanConfig) -> None:
    """Refuse a robot with less torque or speed than the policy needs.

    Raises:
        InputError: an axis with less torque or speed than in training, or whose posture it may not reach.
    """
    own = bundle.control
    axes = own.transmission @ own.posture if own.map is None else own.map.drives(own.posture)
    for k, motor in enumerate(config.motor):
        limits, key = motor.limits, f"motor '{motor.axis}'.limits"
        wanted = (
            ("torque", own.torque_limit[k], limits.torque, "N m"),
            ("velocity", own.velocity_limit or 0.0, limits.velocity, "rad/s"),
        )
        for name, theirs, ours, unit in wanted:
            if theirs > ours + _SAME:
                raise InputError(
                    f"the policy was trained with a {name} limit of {theirs:g} {unit}, '{motor.axis}' may "
                    f"have {ours:g} {unit}", file=config.source, column=f"{key}.{name}",
                    remedy="train it for this robot; raise the limit only if the drive can bear it",
                )  # fmt: skip
        low, high = limits.position
        if not low <= axes[k] <= high:
            raise InputError(
                f"the policy's posture has '{motor.axis}' at {axes[k]:.3g} rad, outside {low:g} to {high:g}",
                file=config.source, column=f"{key}.position",
                remedy="deploy it on the robot it was trained for",
            )  # fmt: skip


def wider(bundle: PolicyBundle, config: CanConfig) -> str:
    """Return a line on limits of the robot that a run does not use; empty if there are none."""
    own = bundle.control.torque_limit
    over = [m.axis for m, most in zip(config.motor, own, strict=True) if m.limits.torque > most + _SAME]
    if not over:
        return ""
    return f"torque limited as in the training ({own.min():g} N m or more): {', '.join(over)}"


def _three(values: np.ndarray) -> str:
    return " ".join(f"{value:g}" for value in values)
