"""More delay between command and torque than the model has."""

from __future__ import annotations

from dataclasses import replace

from workbench.models import Model

from .base import WHOLE, Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values, rows
from .response import Response


class CommandDelay(Effect):
    """torque(t) = command(t - T_d - time) on all axes, T_d the model's own delay;
    the measured torque shows it.
    """

    name = "command_delay"
    parameters = Parameters(
        Parameter(
            "time",
            "s",
            lower=0.0,
            upper=0.2,
            about="beyond the model's delay",
            starts=rows(0.1, 12.0, 14),
            example=0.003,
            linear=False,
        )
    )
    stage = SignalStage.COMMAND
    locations = WHOLE
    words = Words(
        source="transport delay of bus and drive; the paper's T_d (Eq. 15)",
        shows="measured torque lags the command; FRF phase falls with frequency",
        reveal="a multisine up to a quarter of the control rate",
        mujoco="native: delay of the actuator",
    )
    search = Search(frf_signature=FrfSignature.DELAY)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: the late command minus the command in time."""
        return Response.passed(motion, replace(motion.line, delay=motion.line.delay + shape["time"]))

    def before(self, motion: Motion, place: Place, values: Values) -> Motion:
        """Without this delay in the chain."""
        return replace(motion, line=replace(motion.line, delay=motion.line.delay - values["time"]))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Delay of the chain."""
        build.chain.delay_s += values["time"]
