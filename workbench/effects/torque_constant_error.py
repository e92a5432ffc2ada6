"""The torque constant is not the nominal one."""

from __future__ import annotations

from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response, single


class TorqueConstantError(Effect):
    """true torque = gain * measured torque; the measured one is the current times the nominal constant."""

    name = "torque_constant_error"
    parameters = Parameters(Parameter("gain", "1", lower=0.05, upper=20.0, neutral=1.0, example=0.8))
    stage = SignalStage.MOTOR
    words = Words(
        source="motor torque constant, tau = k_t i; spread of magnets, temperature, saturation",
        shows="torque residual proportional to the motor torque at every frequency",
        reveal="a known weight held at several positions",
        mujoco="gain of the actuator",
    )
    search = Search(frf_signature=FrfSignature.GAIN, shared_by_design=True)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: the measured torque; its coefficient is the gain minus one."""
        return Response(single(place, motion.torque[:, place.index], motion)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Gain of the chain."""
        build.chain.gain[place.index] *= values["gain"]
