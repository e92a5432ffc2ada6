"""Dahl's friction: a spring at first, Coulomb friction in the end, with a memory of the last reversal.

    dz/dt = (k / f) w (1 - sign(w) z),    torque = -f z

(P. Dahl, A solid friction model, Aerospace Corp. TOR-0158(3107-18)-1, 1968.) Time drops out: while the slip
goes one way, z depends on the position alone, 1 - s z = (1 - s z0) exp(-(k / f) |x - x0|) with s the way.
This form is exact, bounded, and not stiff at high speed, where dz/dt is.
"""

from __future__ import annotations

from math import exp


class Hysteresis:
    """Presliding friction at one place; it stores its state, so use one per run.

    Args:
        torque: level f that it reaches in the end [N m].
        stiffness: slope k at z = 0 [N m/rad].
    """

    def __init__(self, torque: float, stiffness: float) -> None:
        self._level = torque
        self._rate = stiffness / torque if torque else 0.0
        self._position, self._state = 0.0, 0.0

    def start(self, position: float) -> None:
        """Start relaxed at this position [rad]."""
        self._position, self._state = position, 0.0

    def state(self, position: float) -> float:
        """Return z [1] at a position [rad] that was reached without a reversal."""
        moved = position - self._position
        if moved >= 0.0:
            return 1.0 - (1.0 - self._state) * exp(-self._rate * moved)
        return -1.0 + (1.0 + self._state) * exp(self._rate * moved)

    def torque(self, position: float, speed: float) -> float:
        """Return -f z [N m]."""
        return -self._level * self.state(position)

    def settle(self, position: float) -> None:
        """Start the next slip from this position, in either direction."""
        self._position, self._state = position, self.state(position)
