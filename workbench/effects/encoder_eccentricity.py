"""An encoder disc that does not turn about its own centre."""

from __future__ import annotations

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import Effect, Search, SignalStage, Words, is_rotary
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response, read_on
from .wave import wave

_MOST = 0.5  # rad
#: Any phase; both at their bound still make an amplitude within its own.
_CHART = wave("amplitude", "phase", _MOST / np.sqrt(2.0))


class EncoderEccentricity(Effect):
    """measured position = q + amplitude * sin(q + phase), measured velocity its rate;
    the controller uses these.
    """

    name = "encoder_eccentricity"
    parameters = Parameters(
        Parameter("amplitude", "rad", upper=_MOST, example=0.05),
        Parameter("phase", "rad", lower=-np.pi, upper=np.pi, example=0.7),
        chart=_CHART,
    )
    stage = SignalStage.SENSOR
    words = Words(
        source="disc off centre by d reads d/R sin(q + p) too much; Heidenhain, Rotary Encoders",
        shows="position error with one period per turn; over a small arc like an offset and a scale",
        reveal="a steady turn all the way round, or the widest arc, against a second encoder",
        mujoco="function of the position that is read",
        needs="an axis that turns",
    )
    search = Search(tier=1)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """To axes that turn."""
        return key.axis is None or is_rotary(model, key.axis)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Two columns, sine and cosine of the angle; their coefficients are e cos p and e sin p."""
        position, speed, _ = motion.along(place)
        sine, cosine = np.sin(position), np.cos(position)
        pairs = ((sine, speed * cosine), (cosine, -speed * sine))
        return Response.read(motion, np.stack([read_on(place, *pair, motion) for pair in pairs]))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Sine and cosine of the sensor."""
        (sine, cosine), _ = _CHART.solved(values)
        build.chain.sensors.sine[place.index] += sine
        build.chain.sensors.cosine[place.index] += cosine
