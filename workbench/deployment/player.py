"""Plays an excitation: holds its posture until it is started, then one row per tick."""

from __future__ import annotations

import numpy as np

from workbench.core import InputError
from workbench.frf import Design

from .base import BaseMotion
from .controller import Target

_SETTLE = 1.0  # s for which the posture is held first


class Player:
    """One experiment of a design, as a controller.

    Args:
        design: what to play.
        experiment: which of its experiments.
        period: of the loop [s].

    Attributes:
        reference, feedforward: what is played at each tick (N, n) [rad; N m].
        begun: nominal time of the tick that played the first row [s]; None before.

    Raises:
        InputError: the design's rows do not fall on the loop's ticks.
    """

    def __init__(self, design: Design, experiment: int, period: float) -> None:
        rows = design.rate_hz * period
        if abs(rows - round(rows)) > 1e-9 or rows < 1:
            raise InputError(
                f"the design has {design.rate_hz:g} rows per second, the loop a period of "
                f"{1e3 * period:g} ms",
                remedy="design it with a whole number of rows per period: --rate 1000",
            )
        _, signals = design.play(experiment)
        n = len(design.axes)
        zero = np.zeros((design.rows, n))
        self.reference = signals.get("position_reference", zero)[:: round(rows)]
        self.feedforward = signals.get("torque_feedforward", zero)[:: round(rows)]
        self.begun: float | None = None
        self._period, self._ran = period, np.inf
        self._zero = np.zeros(n)

    @property
    def seconds(self) -> float:
        """Return the duration [s]."""
        return len(self.reference) * self._period

    def done(self, now: float) -> bool:
        """Return whether everything was played at `now` [s]."""
        return self.begun is not None and now >= self.begun + self.seconds

    def target(
        self, now: float, phase: str, position: np.ndarray, velocity: np.ndarray, base: BaseMotion
    ) -> Target:
        """Return the row of this tick; before the first and after the last row, the posture."""
        if phase != "run":
            return Target(self.reference[0], self._zero, now)
        self._ran = min(self._ran, now)
        if self.begun is None and now >= self._ran + _SETTLE:
            self.begun = now
        if self.begun is None:
            return Target(self.reference[0], self._zero, now)
        row = round((now - self.begun) / self._period)
        if row >= len(self.reference):
            return Target(self.reference[-1], self._zero, now)
        return Target(self.reference[row], self.feedforward[row], now)
