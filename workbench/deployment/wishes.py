"""Converts commands of a controller to setpoints of the drives."""

from __future__ import annotations

import numpy as np

from workbench.can import CanConfig
from workbench.core import WorkbenchError
from workbench.core.text import plain

from .controller import Controller, Target
from .feedback import Feedback
from .joints import Joints
from .network import Network
from .safety import SafetyState
from .seen import Setpoints, Wanted


class Wishes:
    """Asks a controller, and closes the loop of the joints around its answer.

    Args:
        config: gains, and who closes the loop.
        network: the clock.
        controller: decides where the joints go.
        joints: the transmission.
        soft_start_s: over which references fade in [s].
    """

    def __init__(
        self, config: CanConfig, network: Network, controller: Controller, joints: Joints, soft_start_s: float
    ) -> None:
        self._network, self._controller, self._joints = network, controller, joints
        self._soft_start = soft_start_s
        self._on_drives = config.loop.pd == "drive"
        self._kp, self._kd = (np.array(gains) for gains in config.gains())
        self._start = np.zeros(len(config.motor))

    def ask(self, tick: float, state: SafetyState, feedback: Feedback) -> tuple[Wanted | None, str | None]:
        """Return the commands, and the exception of the controller if there was one.

        Whatever it raises on purpose or by mistake is a fault of the run; only what is meant to end a program
        (an interrupt, an exit) goes further up.

        Args:
            tick: nominal time of the tick [s].
            state: of safety; nobody is asked while nothing is to move.
            feedback: of the drives.
        """
        if state.phase in ("off", "damp"):
            return None, None
        joints, begun = self._joints, self._network.now()
        position, velocity = joints.motion(feedback.position, feedback.velocity)
        if state.phase == "arm":
            self._start = position
        try:
            target = self._controller.target(tick, state.phase, position, velocity, feedback.base.motion)
            if target is None:
                return None, None
            setpoints = self._setpoints(target, begun, state, feedback, (position, velocity))
        except WorkbenchError as error:
            return None, f"the controller failed: {error}"
        except Exception as error:
            said = plain(" ".join(str(error).split()))  # several lines, or none, with some
            return None, f"the controller failed: {type(error).__name__}: {said}"
        # an answer that took long is as old as its question
        return Wanted(setpoints, max(begun - target.made, self._network.now() - begun)), None

    def _setpoints(
        self, target: Target, now: float, state: SafetyState, feedback: Feedback,
        motion: tuple[np.ndarray, np.ndarray],
    ) -> Setpoints:  # fmt: skip
        joints, n = self._joints, len(self._start)
        position, velocity = motion
        sane = joints.sane(target.reference)
        reference = joints.within(target.reference) if sane else np.full(n, np.nan)
        if state.phase in ("arm", "soft_start") and self._soft_start > 0:
            part = min((now - state.since) / self._soft_start, 1.0) if state.phase == "soft_start" else 0.0
            reference = self._start + part * (reference - self._start)
        zero = np.zeros(n)
        if self._on_drives:
            return Setpoints(joints.axes(reference), zero, self._kp, self._kd, target.feedforward)
        torque = joints.torque(self._kp * (reference - position) - self._kd * velocity, position)
        return Setpoints(feedback.position, zero, zero, zero, torque + target.feedforward)
