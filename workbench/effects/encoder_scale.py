"""An encoder that counts more or less than one turn a turn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response, read_on


class EncoderScale(Effect):
    """measured position = s true position, and so the velocity; the loop reads the same."""

    name = "encoder_scale"
    parameters = (Parameter("scale", "1", lower=0.2, upper=5.0, neutral=1.0),)
    door = Door.SENSOR
    trace = Trace.GAIN
    source = "wrong gear ratio or counts per turn; Springer Handbook of Robotics, Ch. 6"
    shows = "inertia, damping and gravity of one axis all by one factor; gravity of another arc"
    reveal = "a move between two stops whose distance is known"
    mujoco = "factor of the position and the velocity that are read"

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column: the motion itself; its coefficient is the scale minus one."""
        assert place is not None
        position, speed, _ = motion.along(place)
        return Response.read(motion, read_on(place, position, speed, motion)[None])

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """The scale's bounds, less one."""
        scale = self.parameters[0]
        return np.array([scale.lower - 1.0]), np.array([scale.upper - 1.0])

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """Scale is one plus the coefficient."""
        return {"scale": 1.0 + float(coefficients[0])}

    def to_coefficients(self, values: Mapping[str, float]) -> tuple[np.ndarray, dict[str, float]]:
        """The coefficient is the scale minus one."""
        return np.array([values["scale"] - 1.0]), {}

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Scale of the sensor."""
        assert place is not None
        build.chain.sensors.scale[place.index] *= values["scale"]
