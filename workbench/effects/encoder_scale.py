"""An encoder whose counts per turn differ from the stated number."""

from __future__ import annotations

from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response, read_on


class EncoderScale(Effect):
    """measured position = scale * true position, and the same for the velocity; the controller uses these."""

    name = "encoder_scale"
    parameters = Parameters(Parameter("scale", "1", lower=0.2, upper=5.0, neutral=1.0, example=1.06))
    stage = SignalStage.SENSOR
    words = Words(
        source="wrong gear ratio or counts per turn; Springer Handbook of Robotics, Ch. 6",
        shows="inertia, damping and gravity of one axis are all wrong by one factor; gravity follows a "
        "scaled angle",
        reveal="a move between two stops whose distance is known",
        mujoco="factor of the position and the velocity that are read",
    )
    search = Search(frf_signature=FrfSignature.GAIN)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: the motion itself; its coefficient is the scale minus one."""
        position, speed, _ = motion.along(place)
        return Response.read(motion, read_on(place, position, speed, motion)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Scale of the sensor."""
        build.chain.sensors.scale[place.index] *= values["scale"]
