"""Motion of the base, from the messages of an inertial unit on a bus."""

from __future__ import annotations

from collections import deque
from typing import Literal, NamedTuple

import numpy as np

from workbench.can import CanConfig, Frame, FrameError
from workbench.can.imu import IMUS, Quantity

_WHOLE = 0.9  # of a window, which samples have to span
_UNKNOWN = np.full(3, np.nan)


class BaseMotion(NamedTuple):
    """Motion in the frame of the base, (3,); NaN where it is not known.

    Attributes:
        angular: velocity [rad/s].
        gravity: its direction.
        force: that carries the base, per its weight: one, upwards, at rest; none in free fall.
    """

    angular: np.ndarray
    gravity: np.ndarray
    force: np.ndarray = _UNKNOWN


class BaseFeedback:
    """Feedback of the base; without a unit in the configuration it is empty, and never stale.

    Args:
        config: where the unit is.
        stale: age of a frame at which it is not used any more [s].

    Attributes:
        bus: of the unit; empty without one.
        motion: the last sample.
    """

    def __init__(self, config: CanConfig, stale: float) -> None:
        self.bus = config.imu.bus if config.imu else ""
        self.motion = BaseMotion(*np.full((3, 3), np.nan))
        self._unit = IMUS[config.imu.protocol](config.imu.id) if config.imu else None
        self._stale, self._new = stale, -np.inf
        self._stamps: dict[Quantity, float] = dict.fromkeys(self._unit.tells if self._unit else (), -np.inf)
        self._window = config.imu.fall_s if config.imu else 0.0
        self._forces: deque[tuple[float, np.ndarray]] = deque()

    def age(self, now: float) -> float:
        """Return the age of the oldest quantity, by its receive stamp [s]; 0 without a unit."""
        return now - min(self._stamps.values()) if self._unit else 0.0

    def same(self, now: float) -> float:
        """Return for how long the unit has sent the same values [s]; 0 without a unit."""
        return now - self._new if self._unit else 0.0

    @property
    def carried(self) -> float:
        """Return the recent mean of specific force divided by weight; NaN if not known.

        What carries a base is unsteady, and legs that move pull at it; on average it is the weight of whoever
        stays on its feet, and nothing in free fall.
        """
        forces = self._forces
        if not forces or forces[-1][0] - forces[0][0] < _WHOLE * self._window:
            return np.nan
        return float(np.linalg.norm(np.mean([force for _, force in forces], axis=0)))

    def take(self, frame: Frame, stamp: float, now: float) -> Literal["base", "garbage", "old"] | None:
        """Process one frame of its bus; return its kind, or None if it does not come from the unit."""
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
        if quantity == "force":
            self._forces.append((stamp, np.array(values)))
            while self._forces[0][0] < stamp - self._window:
                self._forces.popleft()
        self.motion = self.motion._replace(**{quantity: np.array(values)})
        return "base"
