"""A loop whose gains are not those that the recording states."""

from __future__ import annotations

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import Effect, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response


class ControllerGainError(Effect):
    """torque = kp_scale * kp (q_ref - q) + kd_scale * kd (w_ref - w), in the controller's coordinates.

    Of a cascade, kp_scale scales the gain of the position loop and kd_scale that of the velocity loop.
    """

    name = "controller_gain_error"
    parameters = Parameters(
        Parameter("kp_scale", "1", upper=10.0, neutral=1.0, example=0.7),
        Parameter("kd_scale", "1", upper=10.0, neutral=1.0, example=1.3),
    )
    stage = SignalStage.CONTROLLER
    words = Words(
        source="PD law of the loop; units, scaling or rounding of gains in the drive",
        shows="the torque command differs from the one that the stated gains give for the logged motion",
        reveal="steps of the reference, with command, position and velocity logged",
        mujoco="gains of the controller that runs with the model",
    )

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Once a controller axis."""
        return not model.has(self.name, key.axis)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Two columns: what each gain asks for; coefficients are the scales minus one."""
        shares = motion.law(place.index)
        return Response(np.zeros_like(shares), commands=shares)

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Scales of the loop's gains."""
        build.chain.kp_scale[place.index] *= values["kp_scale"]
        build.chain.kd_scale[place.index] *= values["kd_scale"]
