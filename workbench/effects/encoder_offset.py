"""An encoder whose zero is not where it is believed to be."""

from __future__ import annotations

import numpy as np

from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import INF, Parameter, Parameters, Place, Values
from .response import Response, read_on


class EncoderOffset(Effect):
    """measured position = true position + angle; the controller uses the measured one."""

    name = "encoder_offset"
    parameters = Parameters(Parameter("angle", "rad", lower=-INF, example=0.08))
    stage = SignalStage.SENSOR
    words = Words(
        source="homing error; Hollerbach, Khalil, Gautier, Springer Handbook of Robotics, Ch. 6",
        shows="torque residual like gravity and inertia at a shifted posture, at every speed",
        reveal="holding still all over the range, and an independent measurement of the angle",
        mujoco="offset of the position that is read",
    )
    search = Search(frf_signature=FrfSignature.EVEN)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: the position read is one more."""
        one, zero = np.ones(len(motion.position)), np.zeros(len(motion.position))
        return Response.read(motion, read_on(place, one, zero, motion)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Offset of the sensor."""
        build.chain.sensors.offset[place.index] += values["angle"]
