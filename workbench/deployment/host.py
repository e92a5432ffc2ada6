"""The loop: sends what the last tick computed, then collects feedback and computes.

That is exactly one period from a measurement to its torque: T_d is made here, and by no motor model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from workbench.can import CanConfig, Frame, FrameError, Setpoint
from workbench.core import WorkbenchError
from workbench.core.text import plain

from .controller import Controller
from .feedback import Feedback
from .joints import Joints
from .limits import Limits, limits_of
from .network import Network
from .safety import SafetyState, Seen, Setpoints, Wanted, initial, step
from .statistics import Punctuality
from .verify import Verified, verify

_ASK_AGAIN, _GIVE_UP = 0.6, 0.85  # parts of an exchange
_AWAY = 1.5  # periods without a look, after which the loop itself was held up
_ENABLING = 4  # ticks that drives get to say that they are enabled


@dataclass
class Operator:
    """What a person asks for.

    Attributes:
        arm: motion. stop: the emergency stop is pressed.
    """

    arm: bool = False
    stop: bool = False


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
        punctuality: of the loop.
        operator: what a person asks for.
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
        self._config, self._network, self._controller, self._joints = config, network, controller, joints
        self._limits = limits or limits_of(config)
        self._period, self._polls = config.loop.period_s, config.loop.polls
        self._kp, self._kd = (np.array(gains) for gains in config.gains())
        self._bus = [motor.bus for motor in config.motor]
        self._sign = np.array([motor.sign for motor in config.motor], float)
        self._offset = np.array([motor.offset for motor in config.motor])
        self.feedback = Feedback(config)
        self.state: SafetyState = initial(n)
        self.operator = Operator()
        self.punctuality = Punctuality(counts=self.feedback.counts)
        self._start = np.zeros(n)
        self._verified, self._asked, self._enabling, self._bus_ok = False, False, 0, True
        self.time = 0.0
        self._looked, self._away = -np.inf, False
        self._frames: list[Frame] = []
        self._next: list[Frame] = []

    def verify(self) -> list[Verified]:
        """Asks every drive who it is; nothing can be armed before.

        Raises:
            VerifyError: one is not what the configuration says.
        """
        told = verify(self._config, self._network, self.feedback)
        self._verified = True
        return told

    def run(self, seconds: float, each: Callable[[Host, int], bool | None] | None = None) -> None:
        """Ticks for some time.

        Args:
            seconds: how long.
            each: is called after every tick with its number; True ends the run.
        """
        begin, tick, last = self._network.now() + self._period, 0, ceil(seconds / self._period - 1e-9)
        while tick < last:
            at = begin + tick * self._period
            stale = float(self.feedback.stamp.min()) + self._limits.stale_s + 5e-7
            if self._moving and stale < at:
                self._network.sleep_until(stale)
                if self._stale():
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
        """One period that begins at `at` [s]."""
        self.time = at
        network, gap = self._network, self._period / self._polls
        if self._moving and self._stale():
            self._compute()
            self._frames = self._next  # nothing from before is sent
        for poll in range(self._polls):
            if poll:
                network.sleep_until(at + poll * gap)
            sent = network.now()
            self._send(self._frames)
            self._collect(sent, gap)
            if poll == 0 or (self._moving and self._stale()):
                self._compute()
        self._frames = self._next

    def close(self) -> None:
        """Disables every drive; repeated, as frames get lost."""
        for _ in range(3):
            for index, drive in enumerate(self.feedback.drives):
                self._network.send(self._bus[index], drive.act("disable"))
            until = self._network.now() + self._period
            for arrival in self._network.receive(until):
                self.feedback.take(arrival, self._network.now())
            self._network.sleep_until(until)
        self.state = initial(len(self._bus))

    @property
    def _moving(self) -> bool:
        return self.state.phase in ("arm", "soft_start", "run")

    def _stale(self) -> bool:
        """Whether a drive has been silent too long, by all that has come in: what waits is read first."""
        if not self._old():
            return False
        for arrival in self._network.receive(self._network.now()):
            self.feedback.take(arrival, self._network.now())
        return self._old()

    def _old(self) -> bool:
        return bool((self.feedback.age(self._network.now()) >= self._limits.stale_s).any())

    def _breathe(self, gap: float) -> None:
        """The loop itself was away, so that nothing was asked: damps for one exchange, and looks anew.

        What was computed before is not sent. A drive that is silent still, or that has stopped itself in the
        meantime, is a fault.
        """
        self.punctuality.stalls += 1
        n = len(self._bus)
        zero, q = np.zeros(n), np.clip(self.state.position, self._limits.low, self._limits.high)
        damp = Setpoints(q, zero, zero, np.minimum(self._limits.damping, self._limits.kd), zero)
        self.state = replace(self.state, torque=zero)
        self._frames = self._encode(damp)
        sent = self._network.now()
        self._send(self._frames)
        self._collect(sent, gap, patient=True)

    def _send(self, frames: list[Frame], only: np.ndarray | None = None) -> None:
        """Sends one frame a motor; of all, or of those in `only` (n,)."""
        for index, frame in enumerate(frames):
            if only is None or only[index]:
                self._bus_ok &= self._network.send(self._bus[index], frame)

    def _collect(self, sent: float, gap: float, patient: bool = False) -> None:
        """Takes what comes until every drive has answered; asks those once more that are late.

        Ends where feedback gets stale, unless it is `patient`.
        """
        network, feedback, watched = self._network, self.feedback, self._moving and not patient
        deadline, ask_again, asked = sent + _GIVE_UP * gap, sent + _ASK_AGAIN * gap, not self._frames
        # while everything damps there is time: who else was held up comes back within a period or two
        deadline = sent + 2 * self._period if patient else deadline
        self._away = False
        while True:
            stale = float(feedback.stamp.min()) + self._limits.stale_s + 5e-7 if watched else np.inf
            until = min(deadline, deadline if asked else ask_again, stale)
            for arrival in network.receive(until):
                feedback.take(arrival, network.now())
            now, silent = network.now(), feedback.stamp <= sent
            self._away |= now - max(self._looked, sent) > _AWAY * self._period
            self._looked = now
            if not silent.any():
                self.punctuality.round_trips.append(now - sent)
                return
            if now >= deadline - 1e-9 or (watched and self._stale()):
                break
            if not asked and now >= ask_again - 1e-9:
                asked = True
                self.punctuality.again += int(silent.sum())
                self._send(self._frames, silent)
        self.punctuality.incomplete += 1

    def _compute(self) -> None:
        """Feedback in, the next frames out; what damps goes out at once."""
        f, now, moving = self.feedback, self._network.now(), self._moving
        self._away |= now - self._looked > _AWAY * self._period
        if moving and self._away and (f.age(now) >= self._limits.stale_s).any():
            self._breathe(self._period / self._polls)
            now = self._looked
        self._bus_ok &= all(self._network.ok(bus) for bus in set(self._bus))
        self._prepare()
        wanted, failed = self._wanted(now)
        seen = Seen(
            now, f.position, f.velocity, f.temperature, f.age(now), f.faulty, self._bus_ok,
            self.operator.stop, self.operator.arm and self._enabling == 0, self._verified, f.base.age(now),
            failed,
        )  # fmt: skip
        self._bus_ok = True
        self.state, out = step(self._limits, self.state, seen, wanted)
        try:
            self._next = self._encode(out)
        except FrameError:
            # safety keeps every number where a frame can carry it; should it not, nobody drives
            self._next = [drive.act("disable") for drive in f.drives]
        if moving and not self._moving:
            for bus in set(self._bus):
                self._network.flush(bus)
            self._frames = self._next
            self._send(self._frames)

    def _prepare(self) -> None:
        """Before motion that was asked for anew: buses brought back, drives cleared and enabled."""
        asked, before, self._asked = self.operator.arm, self._asked, self.operator.arm
        self._enabling = max(0, self._enabling - 1)
        if not asked or before or self._moving or self.operator.stop or not self._verified:
            return
        self._enabling = _ENABLING
        for bus in set(self._bus):
            self._network.restart(bus)
        for index, drive in enumerate(self.feedback.drives):
            for action in ("clear", "enable"):
                self._network.send(self._bus[index], drive.act(action))

    def _wanted(self, now: float) -> tuple[Wanted | None, str | None]:
        """What the controller asks for, as setpoints of the drives, and what it failed with."""
        f, joints = self.feedback, self._joints
        position, velocity = joints.position(f.position), joints.position(f.velocity)
        if self.state.phase == "arm":
            self._start = position
        try:
            target = self._controller.target(self.time, self.state.phase, position, velocity, f.base.motion)
        except WorkbenchError as error:
            return None, f"the controller failed: {error}"
        except (ArithmeticError, ValueError) as error:
            said = plain(" ".join(str(error).split()))  # several lines, or none, with some
            return None, f"the controller failed: {type(error).__name__}: {said}"
        if target is None:
            return None, None
        reference = (
            joints.within(target.reference)
            if joints.sane(target.reference)
            else np.full(len(position), np.nan)
        )
        if self.state.phase in ("arm", "soft_start") and self._limits.soft_start_s > 0:
            part = min((now - self.state.since) / self._limits.soft_start_s, 1.0)
            part = 0.0 if self.state.phase == "arm" else part
            reference = self._start + part * (reference - self._start)
        zero = np.zeros_like(position)
        if self._config.loop.pd == "drive":
            setpoints = Setpoints(joints.matrix @ reference, zero, self._kp, self._kd, target.feedforward)
        else:
            torque = joints.torque(self._kp * (reference - position) - self._kd * velocity)
            setpoints = Setpoints(f.position, zero, zero, zero, torque + target.feedforward)
        return Wanted(setpoints, now - target.made), None

    def _encode(self, out: Setpoints) -> list[Frame]:
        """One frame a motor, in the drives' own coordinates."""
        columns = (
            self._sign * (out.position - self._offset), self._sign * out.velocity, out.kp, out.kd,
            self._sign * out.torque,
        )  # fmt: skip
        rows = np.column_stack(columns).tolist()
        return [d.command(Setpoint(*row)) for d, row in zip(self.feedback.drives, rows, strict=True)]
