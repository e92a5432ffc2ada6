"""The drives of any machine, from command to the torque on their rotors, in pieces of a row."""

from __future__ import annotations

from math import exp, floor

import numpy as np

from .drive import Heat, speed_limited
from .own_machine import OwnMachine


class OwnDrives:
    """Delay, limits, current-loop lag (torque is measured here), nonlinear stages, gain, heat, bias.

    A delay need not be whole pieces: over the piece in which a command changes, the mean acts.

    Args:
        machine: the parts of the chain.
        piece: how long one torque is held [s].
        generator: draws what is random in a drive.
    """

    def __init__(self, machine: OwnMachine, piece: float, generator: np.random.Generator) -> None:
        self._machine, self._piece = machine, piece
        whole = floor(machine.delay / piece + 1e-6)
        self._old = max(0.0, machine.delay / piece - whole)  # share of a piece with the command before
        self._old = self._old if self._old > 1e-6 else 0.0
        self._pending = [np.zeros(machine.size)] * (whole + 2)
        self._limit = np.array(machine.limit)
        self._kept = np.array([exp(-piece / lag) if lag else 0.0 for lag in machine.lag])
        self._current = np.zeros(machine.size)
        self._heat = [Heat(each) for each in machine.derating]
        self._reshape = [(axis, make(generator)) for axis, make in machine.reshaped]

    def command(self, torque: np.ndarray, again: bool = False) -> None:
        """Set the commanded torques (n,) of the piece that begins; `again`: in place of those set for it."""
        self._pending.append(np.clip(torque, -self._limit, self._limit))
        self._pending.pop(-2 if again else 0)

    def measured(self, speed: np.ndarray) -> np.ndarray:
        """Return the torque sensors' readings as the piece begins (n,), rotors at `speed` (n,) [rad/s]."""
        target = self._within(self._pending[0 if self._old else 1], speed)
        return np.where(self._kept > 0.0, self._current, target)

    def acting(self, speed: np.ndarray, unmeasured: np.ndarray) -> np.ndarray:
        """Return the mean torque on the rotors over the piece (n,); `unmeasured` (n,) is added at the end."""
        mean = self._old * self._pending[0] + (1.0 - self._old) * self._pending[1]
        target, m = self._within(mean, speed), self._machine
        before = self._current
        self._current = np.where(self._kept > 0.0, target + (before - target) * self._kept, target)
        torque = np.where(self._kept > 0.0, 0.5 * (before + self._current), target)
        for axis, reshape in self._reshape:
            torque[axis] = reshape(float(torque[axis]), self._piece)
        warm = np.array([h.kept(float(u), self._piece) for h, u in zip(self._heat, torque, strict=True)])
        return np.array(m.gain) * warm * torque + np.array(m.bias) + unmeasured

    def _within(self, torque: np.ndarray, speed: np.ndarray) -> np.ndarray:
        if not any(self._machine.speed_limit):
            return torque
        pairs = zip(torque, speed, self._machine.speed_limit, strict=True)
        return np.array([speed_limited(float(u), float(w), limit) for u, w, limit in pairs])
