"""An encoder disc that does not turn about its own centre."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, is_rotary
from .chain import Build
from .motion import Motion
from .response import Response, read_on


class EncoderEccentricity(Effect):
    """measured position = q + e sin(q + p), measured velocity its rate; the loop reads the same."""

    name = "encoder_eccentricity"
    parameters = (
        Parameter("amplitude", "rad", upper=0.5),
        Parameter("phase", "rad", lower=-np.pi, upper=np.pi),
    )
    door = Door.SENSOR
    tier = 1
    needs = "an axis that turns"
    source = "disc off centre by d reads d/R sin(q + p) too much; Heidenhain, Rotary Encoders"
    shows = "position error with one period a turn; over a small arc like an offset and a scale"
    reveal = "a steady turn all the way round, or the widest arc, against a second encoder"
    mujoco = "function of the position that is read"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """To axes that turn."""
        return key.axis is None or is_rotary(model, key.axis)

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """Two columns, sine and cosine of the angle; their coefficients are e cos p and e sin p."""
        assert place is not None
        position, speed, _ = motion.along(place)
        sine, cosine = np.sin(position), np.cos(position)
        pairs = ((sine, speed * cosine), (cosine, -speed * sine))
        return Response.read(motion, np.stack([read_on(place, *pair, motion) for pair in pairs]))

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """Any phase; both at their bound still make an amplitude within its own."""
        top = self.parameters[0].upper / np.sqrt(2.0)
        return np.full(2, -top), np.full(2, top)

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """Amplitude and phase of the two."""
        sine, cosine = map(float, coefficients)
        return {"amplitude": float(np.hypot(sine, cosine)), "phase": float(np.arctan2(cosine, sine))}

    def to_coefficients(self, values: Mapping[str, float]) -> tuple[np.ndarray, dict[str, float]]:
        """e cos p and e sin p."""
        parts = np.array([np.cos(values["phase"]), np.sin(values["phase"])])
        return values["amplitude"] * parts, {}

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Sine and cosine of the sensor."""
        assert place is not None
        (sine, cosine), _ = self.to_coefficients(values)
        build.chain.sensors.sine[place.index] += sine
        build.chain.sensors.cosine[place.index] += cosine
