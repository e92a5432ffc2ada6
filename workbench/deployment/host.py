"""The loop: sends the result of the last tick, then collects feedback and computes.

That is exactly one period from a measurement to its torque: T_d is made here, and by no motor model.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from math import ceil

import numpy as np

from workbench.can import CanConfig, FrameError
from workbench.can.messages import burst

from .controller import Controller
from .deadman import Deadman
from .drives import CALM, Drives, Frames
from .feedback import Feedback
from .joints import Joints
from .limits import Limits, limits_of
from .network import Network
from .operator import Operator
from .safety import SafetyState, damping, initial, step
from .seen import Seen, Wanted
from .statistics import Punctuality
from .verify import Verified, verify
from .wishes import Wishes

_ENABLING = 4  # ticks at least, that drives get to say that they are enabled
_ENABLED_BY = 0.1  # s at most: some drives tell their state only now and then


class Host:
    """The loop of one robot.

    Args:
        config: buses, drives, limits, gains.
        network: the buses and the clock.
        controller: decides where the joints go.
        joints: the transmission.
        limits: default: those of the configuration.

    Attributes:
        state: of safety.
        feedback: what is known of the drives.
        drives: the wire to them.
        operator: what a person asks for.
        axes: their names.
        deadman: watches over the controller where the clock is the machine's; None in simulated time.
        time: nominal time of the last tick [s].
    """

    def __init__(
        self,
        config: CanConfig,
        network: Network,
        controller: Controller,
        joints: Joints,
        limits: Limits | None = None,
    ) -> None:
        n = len(config.motor)
        self._config, self._network, self.axes = config, network, config.axes
        self._limits = limits or limits_of(config)
        self._period, self._polls = config.loop.period_s, config.loop.polls
        self.feedback = Feedback(config)
        self.drives = Drives(config, network, self.feedback, self._limits.stale_s)
        self._wishes = Wishes(config, network, controller, joints, self._limits.soft_start_s)
        self.state: SafetyState = initial(n)
        self.operator = Operator(watches=[lambda: self.feedback.stop.said(network.now())])
        self.deadman: Deadman | None = None
        self._verified, self._asked, self._enabling, self._enabled_by = False, False, 0, 0.0
        self.time = 0.0
        self._frames: list[Frames] = []
        self._next: list[Frames] = []

    def verify(self) -> list[Verified]:
        """Ask every drive for its identity and settings; nothing can be armed before.

        Raises:
            VerifyError: one is not what the configuration says.
        """
        told = verify(self._config, self._network, self.feedback)
        self._verified = True
        return told

    def run(self, seconds: float, each: Callable[[Host, int], bool | None] | None = None) -> None:
        """Run ticks for some time.

        Args:
            seconds: how long.
            each: is called after every tick with its number; True ends the run.
        """
        begin, tick, last = self._network.now() + self._period, 0, ceil(seconds / self._period - 1e-9)
        while tick < last:
            at = begin + tick * self._period
            if self._moving and self.drives.due() < at:
                self._network.sleep_until(self.drives.due())
                if self.drives.stale():
                    self._compute()
            self._network.sleep_until(at)
            self.punctuality.late.append(self._network.now() - at)
            self.tick(at)
            if each and each(self, tick):
                return
            # a tick that is past is skipped: two at once would be a burst
            following = max(tick + 1, ceil((self._network.now() - begin) / self._period - 1e-6))
            self.punctuality.skipped += following - tick - 1
            tick = following

    def tick(self, at: float) -> None:
        """Run one period that begins at `at` [s]."""
        self.time = at
        network, gap = self._network, self._period / self._polls
        self.operator.look()
        if self._moving and self.drives.stale():
            self._compute()
            self._frames = self._next  # nothing from before is sent
        for poll in range(self._polls):
            if poll:
                network.sleep_until(at + poll * gap)
            self._exchange(gap)
            if poll == 0 or (self._moving and self.drives.stale()):
                self._compute()
        self._frames = self._next

    def close(self, calm: float = CALM) -> None:
        """End the run: damp at once and for some time, then disable every drive.

        Whatever fails meanwhile, the drives get their damping and are told to stop; nothing but what is meant
        to end a program is raised, and that only after it.

        Args:
            calm: how long it damps [s]; drives that were never enabled are disabled at once.
        """
        self.operator.arm = False
        try:
            if self.state.phase != "off":
                self._calm(self._damp(), calm)
        finally:
            self.drives.disable()
            self.state = initial(len(self._config.motor))

    @property
    def punctuality(self) -> Punctuality:
        """Return the punctuality of the loop."""
        return self.drives.punctuality

    @property
    def over(self) -> bool:
        """Return whether nothing will move before somebody arms again: damped, stopped, or not armed."""
        state = self.state
        return (
            self.operator.stop or state.phase == "damp" or (state.phase == "off" and state.fault is not None)
        )

    def count_anew(self) -> Punctuality:
        """Start counting again; return what was counted before."""
        before, self.feedback.counts = self.drives.punctuality, Counter()
        self.drives.punctuality = Punctuality(counts=self.feedback.counts)
        return before

    @property
    def _moving(self) -> bool:
        return self.state.phase in ("arm", "soft_start", "run")

    def _calm(self, damping: list[Frames], seconds: float) -> None:
        try:
            self.drives.send(damping)
            self.run(seconds)
        except BaseException as error:
            self.drives.let_down(damping, seconds)
            if not isinstance(error, Exception):
                raise

    def _damp(self) -> list[Frames]:
        """From now on everything damps; returns the frames that say so."""
        phase, zero = self.state.phase, np.zeros_like(self.state.torque)
        since = self.state.since if phase == "damp" else self._time()
        self.state = replace(self.state, phase="damp", since=since, torque=zero)
        self._frames = self._next = self.drives.encode(damping(self._limits, self.state.position))
        return self._frames

    def _time(self) -> float:
        try:
            return self._network.now()
        except Exception:  # on the way out a clock is not needed
            return self.state.time

    def _exchange(self, gap: float, patient: bool = False) -> None:
        """Sends one frame per drive and takes what comes."""
        sent = self._network.now()
        self.drives.send(self._frames)
        self.drives.collect(self._frames, sent, gap, self._moving and not patient, patient)

    def _breathe(self, gap: float) -> None:
        """The loop itself was away, so that nothing was asked: damps for one exchange, and looks anew.

        What was computed before is not sent. A drive that is silent still, or that has stopped itself in the
        meantime, is a fault.
        """
        self.punctuality.stalls += 1
        self.state = replace(self.state, torque=np.zeros_like(self.state.torque))
        self._frames = self.drives.encode(damping(self._limits, self.state.position))
        self._exchange(gap, patient=True)

    def _compute(self) -> None:
        """Feedback in, the next frames out; what damps goes out at once."""
        f, drives, now, moving = self.feedback, self.drives, self._network.now(), self._moving
        if moving and drives.held_up(now) and (f.age(now) >= self._limits.stale_s).any():
            self._breathe(self._period / self._polls)
            now = drives.looked
        drives.took &= drives.ok()
        self._prepare()
        wanted, failed = self._ask()
        seen = Seen(
            now, f.position, f.velocity, f.temperature, f.age(now), f.faulty, drives.took,
            self.operator.stop, self.operator.arm and not self._enabling, self._verified, f.base.age(now),
            failed, drives.gap, f.base.same(now), f.base.carried, f.torque, f.base.motion.gravity,
        )  # fmt: skip
        drives.took, drives.gap = True, 0.0
        self.state, out = step(self._limits, self.state, seen, wanted)
        try:
            self._next = drives.encode(out)
        except FrameError:
            # safety keeps every number where a frame can carry it; should it not, nobody drives
            self._next = [burst(drive.act("disable")) for drive in f.drives]
        if moving and not self._moving:
            drives.flush()
            self._frames = self._next
            drives.send(self._frames)

    def _ask(self) -> tuple[Wanted | None, str | None]:
        if self.deadman is None or not self._moving:
            return self._wishes.ask(self.time, self.state, self.feedback)
        with self.deadman.over(self.drives.encode(damping(self._limits, self.state.position))):
            return self._wishes.ask(self.time, self.state, self.feedback)

    def _prepare(self) -> None:
        """Before motion that was asked for anew: buses brought back, drives cleared and enabled."""
        asked, before, self._asked = self.operator.arm, self._asked, self.operator.arm
        if self._enabling > 1 or not self.feedback.faulty.any() or self._network.now() >= self._enabled_by:
            self._enabling = max(0, self._enabling - 1)
        if not asked or before or self._moving or self.operator.stop or not self._verified:
            return
        self._enabling, self._enabled_by = _ENABLING, self._network.now() + _ENABLED_BY
        self.drives.restart()
        self.drives.act("clear", "enable")
