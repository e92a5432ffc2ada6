"""Drag that grows with the square of the speed: air, oil, a fan."""

from __future__ import annotations

import numpy as np

from workbench.models import Model

from .base import Effect, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response, single


class QuadraticDrag(Effect):
    """torque = -drag * w |w|."""

    name = "quadratic_drag"
    parameters = Parameters(Parameter("drag", "N*m*s^2/rad^2", example=0.03))
    stage = SignalStage.FRICTION
    locations = ("actuator", "joint")
    words = Words(
        source="Rayleigh's drag equation; windage and churning losses",
        shows="torque residual odd in speed, growing with its square",
        reveal="steady runs at several speeds up to the highest, in both directions",
        mujoco="native: quadratic damping of the axis's tendon (MuJoCo 4)",
    )

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: minus the speed times its size."""
        _, speed, _ = motion.along(place)
        return Response(single(place, -speed * np.abs(speed), motion)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Second damping coefficient of the tendon."""
        build.spec.tendon(place.tendon).damping[1] += values["drag"]
