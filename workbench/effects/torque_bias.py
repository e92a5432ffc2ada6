"""A constant torque: current-sensor offset, a preloaded cable, a weight on a slide."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.models import Model, Placement

from .base import INF, Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response, single


class TorqueBias(Effect):
    """torque = + b, behind the tap of the measured torque."""

    name = "torque_bias"
    parameters = (Parameter("torque", "N*m", lower=-INF),)
    door = Door.MOTOR
    trace = Trace.EVEN
    source = "current-sensor offset; Janot et al. 2019 (offset of the EMPS)"
    shows = "torque residual even in speed, the same at every position, speed and time"
    reveal = "standing still at several positions, each approached from both sides"
    mujoco = "bias of the actuator"

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column of ones."""
        assert place is not None
        return Response(single(place, np.ones(len(motion.position)), motion)[None])

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Bias of the chain."""
        assert place is not None
        build.chain.bias[place.index] += values["torque"]
