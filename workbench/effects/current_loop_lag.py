"""A current loop that follows its command with a lag."""

from __future__ import annotations

from dataclasses import replace

from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values, rows
from .response import Response


class CurrentLoopLag(Effect):
    """time_constant * du/dt = command - u, after delay and limits; u is the measured torque."""

    name = "current_loop_lag"
    parameters = Parameters(
        Parameter("time_constant", "s", upper=0.5, starts=rows(0.1, 30.0, 14), example=0.006, linear=False)
    )
    stage = SignalStage.COMMAND
    words = Words(
        source="closed current loop as a first-order lag; Krause et al., Analysis of Electric "
        "Machinery, Ch. 15",
        shows="measured torque follows steps of the command late and rounded; "
        "FRF magnitude and phase fall together",
        reveal="a multisine up to a quarter of the control rate, or steps of torque",
        mujoco="native: filter of the actuator",
    )
    search = Search(frf_signature=FrfSignature.DELAY)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: the lagging torque minus the torque without lag."""
        lag = motion.line.lag.copy()
        lag[place.index] += shape["time_constant"]
        return Response.passed(motion, replace(motion.line, lag=lag))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Lag of the chain; lags of one drive add up."""
        build.chain.lag[place.index] += values["time_constant"]
