"""The commanded velocity of a walking policy: it starts at zero and is approached with a ramp."""

from __future__ import annotations

import numpy as np

RATE = (0.8, 0.4, 1.0)  # m/s^2, m/s^2, rad/s^2: what is asked for is reached within a second or so


class Command:
    """A velocity that moves towards the commanded one, no faster than `RATE`.

    Attributes:
        asked: forward, sideward and turning speed (3,) [m/s, m/s, rad/s]; may change at any time.
        value: what the policy sees now (3,).
    """

    def __init__(self, asked: np.ndarray | None = None) -> None:
        self.asked = np.zeros(3) if asked is None else asked
        self.value = np.zeros(3)

    def stand(self) -> None:
        """Start again from zero."""
        self.value = np.zeros(3)

    def advance(self, seconds: float) -> np.ndarray:
        """Return the velocity (3,) some time later."""
        room = np.array(RATE) * seconds
        self.value = self.value + np.clip(self.asked - self.value, -room, room)
        return self.value
