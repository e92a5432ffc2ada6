"""An encoder whose zero is not where it is believed to be."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.models import Model, Placement

from .base import INF, Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response, read_on


class EncoderOffset(Effect):
    """measured position = true position + a; the loop reads the same."""

    name = "encoder_offset"
    parameters = (Parameter("angle", "rad", lower=-INF),)
    door = Door.SENSOR
    trace = Trace.EVEN
    source = "homing error; Hollerbach, Khalil, Gautier, Springer Handbook of Robotics, Ch. 6"
    shows = "torque residual as of gravity and inertia at another posture, whatever the speed"
    reveal = "holding still all over the range, and an independent measurement of the angle"
    mujoco = "offset of the position that is read"

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column: the position read is one more."""
        assert place is not None
        one, zero = np.ones(len(motion.position)), np.zeros(len(motion.position))
        return Response.read(motion, read_on(place, one, zero, motion)[None])

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Offset of the sensor."""
        assert place is not None
        build.chain.sensors.offset[place.index] += values["angle"]
