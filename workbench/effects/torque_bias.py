"""A constant torque: current-sensor offset, a preloaded cable, a weight on a slide."""

from __future__ import annotations

import numpy as np

from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import INF, Parameter, Parameters, Place, Values
from .response import Response, single


class TorqueBias(Effect):
    """A constant torque on the axis, the parameter `torque`, which the measured torque does not contain."""

    name = "torque_bias"
    parameters = Parameters(Parameter("torque", "N*m", lower=-INF, example=-0.4))
    stage = SignalStage.MOTOR
    words = Words(
        source="current-sensor offset; Janot et al. 2019 (offset of the EMPS)",
        shows="a constant torque residual, the same at every position, speed and time",
        reveal="standing still at several positions, each approached from both sides",
        mujoco="bias of the actuator",
    )
    search = Search(frf_signature=FrfSignature.EVEN)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column of ones."""
        return Response(single(place, np.ones(len(motion.position)), motion)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Bias of the chain."""
        build.chain.bias[place.index] += values["torque"]
