"""How the base of a robot turns and where down is, from what an inertial unit on a bus says."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from workbench.can import CanConfig, Frame, FrameError
from workbench.can.imu import IMUS, Quantity


class BaseMotion(NamedTuple):
    """In the base's frame (3,): angular velocity [rad/s], direction of gravity; NaN where none is known."""

    angular: np.ndarray
    gravity: np.ndarray


class BaseFeedback:
    """What is known of the base; without a unit in the configuration nothing, and nothing is missed.

    Args:
        config: where the unit is.
        stale: age of a frame at which it is not used any more [s].

    Attributes:
        bus: of the unit; empty without one.
        motion: the last sample.
    """

    def __init__(self, config: CanConfig, stale: float) -> None:
        self.bus = config.imu.bus if config.imu else ""
        self.motion = BaseMotion(np.full(3, np.nan), np.full(3, np.nan))
        self._unit = IMUS[config.imu.protocol](config.imu.id) if config.imu else None
        self._stale, self._new = stale, -np.inf
        self._stamps: dict[Quantity, float] = {"angular": -np.inf, "gravity": -np.inf}

    def age(self, now: float) -> float:
        """Of the older of both quantities, by its receive stamp [s]; 0 without a unit."""
        return now - min(self._stamps.values()) if self._unit else 0.0

    def same(self, now: float) -> float:
        """Since how long it has said nothing new [s]; 0 without a unit."""
        return now - self._new if self._unit else 0.0

    def take(self, frame: Frame, stamp: float, now: float) -> Literal["base", "garbage", "old"] | None:
        """One frame of its bus; returns what it was, None where it is not the unit's."""
        if self._unit is None:
            return None
        try:
            said = self._unit.decode(frame)
        except FrameError:
            return "garbage"
        if said is None:
            return None
        quantity, values = said
        if stamp <= self._stamps[quantity] or now - stamp >= self._stale or stamp > now + 1e-3:
            return "old"
        self._stamps[quantity] = stamp
        if not np.array_equal(getattr(self.motion, quantity), values):
            self._new = stamp
        self.motion = self.motion._replace(**{quantity: np.array(values)})
        return "base"
