"""Observations of a policy on hardware that drives and an inertial unit can provide, by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from workbench.bundle import ObservationEntry
from workbench.can import CanConfig
from workbench.core import InputError

PITCH_HZ = 5.0  # paper, Sec. V: the base pitches as this sine


class Reach(NamedTuple):
    """A sine per joint: middle + amplitude sin(rate t + phase), each (n,) [rad, rad, rad/s, rad]."""

    middle: np.ndarray
    amplitude: np.ndarray
    rate: np.ndarray
    phase: np.ndarray

    def position(self, time: float) -> np.ndarray:
        """Return joint angles (n,) [rad] at `time` [s]."""
        return self.middle + self.amplitude * np.sin(self.rate * time + self.phase)

    def velocity(self, time: float) -> np.ndarray:
        """Return joint speeds (n,) [rad/s] at `time` [s]."""
        return self.amplitude * self.rate * np.cos(self.rate * time + self.phase)


class Sight(NamedTuple):
    """State at the time when a policy is asked; arrays (n,) of joints.

    Attributes:
        position, velocity: [rad, rad/s]. posture: of the policy [rad]. action: the last.
        goal: to follow. time: since the policy began [s]. step: from one action to the next [s].
        angular, gravity: of the base, in its frame (3,) [rad/s; direction].
        twist: forward, sideward and turning speed that is asked for (3,) [m/s, m/s, rad/s].
    """

    position: np.ndarray
    velocity: np.ndarray
    posture: np.ndarray
    action: np.ndarray
    goal: Reach
    time: float
    step: float
    angular: np.ndarray
    gravity: np.ndarray
    twist: np.ndarray


def _ahead(s: Sight) -> np.ndarray:
    return np.concatenate([s.goal.position(s.time + k * s.step) - s.posture for k in (0, 1, 2, 4)])


def _pitch(s: Sight) -> np.ndarray:
    angle = 2.0 * np.pi * PITCH_HZ * s.time
    return np.array([np.sin(angle), np.cos(angle)])


#: As the tasks name them; what needs more than drives and an inertial unit (speed, feet) is not here.
OBSERVATIONS: dict[str, Callable[[Sight], np.ndarray]] = {
    "joint_offset": lambda s: s.position - s.posture,
    "joint_velocity": lambda s: s.velocity,
    "last_action": lambda s: s.action,
    "reach_error": lambda s: s.position - s.goal.position(s.time),
    "reach_ahead": _ahead,
    "reach_speed": lambda s: s.goal.velocity(s.time),
    "base_angular": lambda s: s.angular,
    "gravity": lambda s: s.gravity,
    "pitch_phase": _pitch,
    "velocity_command": lambda s: s.twist,
}
OF_THE_BASE = ("base_angular", "gravity")


def observe(entries: tuple[ObservationEntry, ...], sight: Sight) -> np.ndarray:
    """Return the input of the policy (k,)."""
    return np.concatenate([entry.scale * OBSERVATIONS[entry.name](sight) for entry in entries])


def check_layout(entries: tuple[ObservationEntry, ...], n: int, config: CanConfig) -> None:
    """Refuse a layout that cannot be computed from n joints and the devices of a configuration.

    Raises:
        InputError: an observation that nothing here can tell, or of another size or place.
    """
    ones, three = np.ones(n), np.ones(3)
    sight = Sight(ones, ones, ones, ones, Reach(ones, ones, ones, ones), 0.0, 0.018, three, three, three)
    at = 0
    for entry in entries:
        if entry.name not in OBSERVATIONS:
            known = ", ".join(OBSERVATIONS)
            raise InputError(
                f"the policy needs the observation '{entry.name}', which is not available here",
                remedy=f"known: {known}",
            )
        if entry.name in OF_THE_BASE and config.imu is None:
            raise InputError(
                f"the policy needs the observation '{entry.name}', but there is no inertial unit",
                file=config.source,
                column="imu", remedy="say where it is: [imu] with bus, protocol and id",
            )  # fmt: skip
        size = len(OBSERVATIONS[entry.name](sight))
        if (entry.start, entry.size) != (at, size):
            problem = f"'{entry.name}' has {entry.size} numbers from {entry.start}, here {size} from {at}"
            raise InputError(problem, remedy="export it with this version, for this robot")
        at += size
