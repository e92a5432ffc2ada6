"""Stribeck friction: more at standstill than in motion."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, Trace
from .chain import Build, FrictionTerm
from .law import law
from .motion import Motion
from .response import Response, single, smooth_sign


class StribeckFriction(Effect):
    """torque = -(fc + (fs - fc) exp(-(w / vs)^2)) sign(w), with fs >= fc."""

    name = "stribeck_friction"
    parameters = (
        Parameter("coulomb", "N*m"),
        Parameter("static", "N*m"),
        Parameter("speed", "rad/s", lower=1e-6),
    )
    nonlinear = ("speed",)
    door = Door.FRICTION
    depends_on = ("speed",)
    dry = True
    tier = 1
    contains = ("coulomb_friction",)
    locations = ("actuator", "joint")
    of_a_make = True
    trace = Trace.ODD
    source = "Stribeck 1902; Armstrong-Helouvry et al., Automatica 30(7), 1994, Eq. 6"
    shows = "torque residual odd in speed, with a peak at low speed that falls to a plateau"
    reveal = "very slow steady runs, from creeping upwards, in both directions"
    mujoco = "torque function of the speed: the level of the axis's friction loss, step by step"

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """Stribeck speeds from 0.5 % to 50 % of the top speed in the first recording."""
        assert place is not None
        _, speed, _ = motions[0].along(place)
        top = float(np.quantile(np.abs(speed), 0.99)) + 1e-9
        return [{"speed": float(v)} for v in top * np.geomspace(0.005, 0.5, 9)]

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """Two columns: the plateau and the excess at low speed."""
        assert place is not None
        _, speed, _ = motion.along(place)
        plateau = -smooth_sign(speed)
        excess = plateau * np.exp(-((speed / shape["speed"]) ** 2))
        return Response(np.stack([single(place, row, motion) for row in (plateau, excess)]))

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """Static friction is the plateau plus the excess."""
        plateau, excess = map(float, coefficients)
        return {"coulomb": plateau, "static": plateau + excess, "speed": shape["speed"]}

    def to_coefficients(self, values: Mapping[str, float]) -> tuple[np.ndarray, dict[str, float]]:
        """The excess is static minus Coulomb friction."""
        plateau = values["coulomb"]
        return np.array([plateau, values["static"] - plateau]), {"speed": values["speed"]}

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """A friction level of the tendon that depends on the speed."""
        assert place is not None
        parameters = values["coulomb"], values["static"], values["speed"]
        build.chain.friction.append(FrictionTerm(place.tendon, stribeck_level, parameters))


@law
def stribeck_level(speed: float, torque: float, p: Sequence[float]) -> float:
    """Bound on the friction at a speed; Coulomb, static, Stribeck speed."""
    return p[0] + (p[1] - p[0]) * math.exp(-((speed / p[2]) ** 2))
