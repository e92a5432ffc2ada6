"""More delay between command and torque than the model has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response


class CommandDelay(Effect):
    """torque(t) = command(t - T_d - time), on all axes, before the measured torque."""

    name = "command_delay"
    parameters = (Parameter("time", "s", lower=0.0, upper=0.2, about="beyond the model's delay"),)
    nonlinear = ("time",)
    twins_by_command = ("sensor_delay",)
    door = Door.COMMAND
    axes = "all"
    trace = Trace.DELAY
    source = "transport delay of bus and drive; the paper's T_d (Eq. 15)"
    shows = "measured torque late against the command; FRF phase falls with frequency"
    reveal = "a multisine up to a quarter of the control rate"
    mujoco = "native: delay of the actuator"

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """Delays from a tenth of a row to some rows beyond the controller's usual step."""
        step = motions[0].step
        longest = max(12.0 * step, 0.012)
        return [{"time": float(t)} for t in np.geomspace(0.1 * step, longest, 14)]

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """No free coefficient: the late command minus the command in time."""
        return Response.passed(motion, replace(motion.line, delay=motion.line.delay + shape["time"]))

    def before(self, motion: Motion, place: Placement | None, values: Mapping[str, float]) -> Motion:
        """Without this delay in the chain."""
        return replace(motion, line=replace(motion.line, delay=motion.line.delay - values["time"]))

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Delay of the chain."""
        build.chain.delay_s += values["time"]
