"""A current loop that follows its command with a lag."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response


class CurrentLoopLag(Effect):
    """T du/dt = asked - u, u the measured torque, behind delay and limits."""

    name = "current_loop_lag"
    parameters = (Parameter("time_constant", "s", upper=0.5),)
    nonlinear = ("time_constant",)
    by_runs = True
    door = Door.COMMAND
    of_a_make = True
    trace = Trace.DELAY
    source = "closed current loop as a first-order lag; Krause et al., Analysis of Electric Machinery, Ch. 15"
    shows = "measured torque rounded against the command's edges; FRF magnitude and phase fall together"
    reveal = "a multisine up to a quarter of the control rate, or steps of torque"
    mujoco = "native: filter of the actuator"

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """Lags from a tenth of a row to some periods of the loop."""
        step = motions[0].step
        longest = max(30.0 * step, 0.03)
        return [{"time_constant": float(t)} for t in np.geomspace(0.1 * step, longest, 14)]

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """No free coefficient: the lagging torque minus the torque without lag."""
        assert place is not None
        lag = motion.line.lag.copy()
        lag[place.index] += shape["time_constant"]
        return Response.passed(motion, replace(motion.line, lag=lag))

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Lag of the chain; lags of one drive add up."""
        assert place is not None
        build.chain.lag[place.index] += values["time_constant"]
