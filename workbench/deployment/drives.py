"""The connection to all drives of a robot: setpoints, answers, and the end of a run."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from math import ceil

import numpy as np

from workbench.can import CanConfig, Frame, Setpoint
from workbench.can.messages import Action, burst

from .feedback import Feedback
from .network import Network
from .seen import Setpoints
from .statistics import Punctuality

#: What one drive is told at once; most protocols need one frame.
Frames = tuple[Frame, ...]
_ASK_AGAIN, _GIVE_UP = 0.6, 0.85  # parts of an exchange
_AWAY = 1.5  # periods without a look, after which the loop itself was held up
CALM = 0.5  # s of damping before drives are disabled
_REPEATS = 3  # of what must arrive: frames get lost


class Drives:
    """The frames of one exchange, in drive coordinates.

    Args:
        config: buses and drives.
        network: the buses and the clock.
        feedback: takes what comes in.
        stale_s: age at which feedback is not used any more [s].

    Attributes:
        punctuality: counts what was late.
        took: whether every bus took what it was given since this was last set.
        away: whether the loop itself was held up since the last exchange began.
        looked: when it last looked [s].
        gap: the longest time between two commands since this was last set to 0 [s].
    """

    def __init__(self, config: CanConfig, network: Network, feedback: Feedback, stale_s: float) -> None:
        self._network, self.feedback, self._stale_s = network, feedback, stale_s
        self._period = config.loop.period_s
        self.bus = [motor.bus for motor in config.motor]
        self._sign = np.array([motor.sign for motor in config.motor], float)
        self._offset = np.array([motor.offset for motor in config.motor])
        self.punctuality = Punctuality(counts=feedback.counts)
        self.took, self.away, self.looked, self.gap = True, False, -np.inf, 0.0
        self._told = np.inf  # when all were last commanded [s]

    def encode(self, out: Setpoints) -> list[Frames]:
        """Return the frames of one setpoint per drive.

        Raises:
            FrameError: a number that no frame can carry.
        """
        columns = (
            self._sign * (out.position - self._offset), self._sign * out.velocity, out.kp, out.kd,
            self._sign * out.torque,
        )  # fmt: skip
        rows = np.column_stack(columns).tolist()
        return [burst(d.command(Setpoint(*row))) for d, row in zip(self.feedback.drives, rows, strict=True)]

    def send(self, frames: Sequence[Frames], only: np.ndarray | None = None) -> None:
        """Send the frames of each drive, to all or to those in `only` (n,)."""
        for index, each in enumerate(frames):
            if only is None or only[index]:
                for frame in each:
                    self.took &= self._network.send(self.bus[index], frame)
        if only is None and frames:
            now = self._network.now()
            self.gap, self._told = max(self.gap, now - self._told), now

    def act(self, *actions: Action) -> None:
        """Send an action to every drive."""
        for index, drive in enumerate(self.feedback.drives):
            for action in actions:
                for frame in burst(drive.act(action)):
                    self._network.send(self.bus[index], frame)

    def flush(self) -> None:
        """Discard what is queued on every bus."""
        for bus in set(self.bus):
            self._network.flush(bus)

    def restart(self) -> None:
        """Restart buses that were off, and the count of gaps between commands."""
        self.gap, self._told = 0.0, np.inf
        for bus in set(self.bus):
            self._network.restart(bus)

    def ok(self) -> bool:
        """Return whether all buses carry frames."""
        return all(self._network.ok(bus) for bus in set(self.bus))

    def due(self) -> float:
        """Return the time at which the oldest feedback becomes stale [s]."""
        return float(self.feedback.stamp.min()) + self._stale_s + 5e-7

    def stale(self) -> bool:
        """Return whether a drive has been silent for too long; waiting frames are read first."""
        if not self._old():
            return False
        self._take(self._network.now())
        return self._old()

    def collect(
        self, frames: Sequence[Frames], sent: float, gap: float, watched: bool, patient: bool
    ) -> None:
        """Receive until every drive has answered; send once more to those that are late.

        Args:
            frames: that were sent.
            sent: when [s].
            gap: from this exchange to the next [s].
            watched: ends where feedback gets stale.
            patient: everything damps, so that there is time: who was held up comes back within two periods.
        """
        network, feedback = self._network, self.feedback
        deadline, ask_again, asked = sent + _GIVE_UP * gap, sent + _ASK_AGAIN * gap, not frames
        deadline = sent + 2 * self._period if patient else deadline
        self.away = False
        while True:
            stale = self.due() if watched else np.inf
            self._take(min(deadline, deadline if asked else ask_again, stale))
            now, silent = network.now(), feedback.stamp <= sent
            self.away |= now - max(self.looked, sent) > _AWAY * self._period
            self.looked = now
            if not silent.any():
                self.punctuality.round_trips.append(now - sent)
                return
            if now >= deadline - 1e-9 or (watched and self.stale()):
                break
            if not asked and now >= ask_again - 1e-9:
                asked = True
                self.punctuality.again += int(silent.sum())
                self.send(frames, silent)
        self.punctuality.incomplete += 1

    def held_up(self, now: float) -> bool:
        """Return whether the loop itself was delayed."""
        self.away |= now - self.looked > _AWAY * self._period
        return self.away

    def let_down(self, damping: Sequence[Frames], seconds: float) -> None:
        """Send damping for some time, whatever fails; only the buses are needed."""
        for _ in range(ceil(seconds / self._period)):
            self._tell(damping)

    def disable(self) -> None:
        """Disable every drive, whatever fails."""
        for _ in range(_REPEATS):
            self._tell([burst(drive.act("disable")) for drive in self.feedback.drives])

    def _tell(self, frames: Sequence[Frames]) -> None:
        """Its frames to each drive, and a period to hear what they say; raises nothing."""
        for bus, each in zip(self.bus, frames, strict=True):
            for frame in each:
                with suppress(Exception):
                    self._network.send(bus, frame)
        try:
            until = self._network.now() + self._period
            with suppress(Exception):
                self._take(until)
            self._network.sleep_until(until)
        except Exception:
            time.sleep(self._period)

    def _take(self, until: float) -> None:
        for arrival in self._network.receive(until):
            self.feedback.take(arrival, self._network.now())

    def _old(self) -> bool:
        return bool((self.feedback.age(self._network.now()) >= self._stale_s).any())
