"""Stribeck friction: more at standstill than in motion."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build, FrictionTerm
from .corrected import down_to, own_dry_friction
from .law import law
from .motion import Motion
from .parameter import Chart, Parameter, Parameters, Place, Unknown, Values
from .response import Response, single, smooth_sign
from .setting import SLIDING_SPEED


def _speeds(motions: Sequence[Motion], model: Model, place: Place) -> np.ndarray:
    """Stribeck speeds from 0.5 % to 50 % of the top speed in the first recording."""
    _, speed, _ = motions[0].along(place)
    return (float(np.quantile(np.abs(speed), 0.99)) + 1e-9) * np.geomspace(0.005, 0.5, 9)


def _values(coefficients: np.ndarray, shape: Values) -> dict[str, float]:
    """Static friction is the plateau plus the excess."""
    plateau, excess = map(float, coefficients)
    return {"coulomb": plateau, "static": plateau + excess, "speed": shape["speed"]}


def _solved(values: Values) -> tuple[np.ndarray, dict[str, float]]:
    """The excess is static minus Coulomb friction."""
    plateau = values["coulomb"]
    return np.array([plateau, values["static"] - plateau]), {"speed": values["speed"]}


_EXCESS = Chart(
    (
        Unknown("plateau", within=down_to(own_dry_friction)),
        Unknown("excess"),
        Unknown("speed", lower=1e-6, linear=False, starts=_speeds),
    ),
    _values,
    _solved,
)


class StribeckFriction(Effect):
    """torque = -(coulomb + (static - coulomb) exp(-(w / speed)^2)) sign(w), with static >= coulomb."""

    name = "stribeck_friction"
    parameters = Parameters(
        Parameter("coulomb", "N*m", within=down_to(own_dry_friction), example=0.15),
        Parameter("static", "N*m", within=down_to(own_dry_friction), example=0.45),
        Parameter("speed", "rad/s", lower=1e-6, example=0.5, linear=False),
        chart=_EXCESS,
        settles=(SLIDING_SPEED,),
    )
    stage = SignalStage.FRICTION
    locations = ("actuator", "joint")
    words = Words(
        source="Stribeck 1902; Armstrong-Helouvry et al., Automatica 30(7), 1994, Eq. 6",
        shows="torque residual odd in speed, with a peak at low speed that falls to a plateau",
        reveal="very slow steady runs, from creeping upwards, in both directions",
        mujoco="torque function of the speed: the level of the axis's friction loss, step by step",
    )
    search = Search(contains=("coulomb_friction",), frf_signature=FrfSignature.ODD)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Two columns: the plateau and the excess at low speed."""
        _, speed, _ = motion.along(place)
        plateau = -smooth_sign(motion.sliding(place))
        excess = plateau * np.exp(-((speed / shape["speed"]) ** 2))
        return Response(np.stack([single(place, row, motion) for row in (plateau, excess)]))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A friction level of the tendon that depends on the speed."""
        parameters = values["coulomb"], values["static"], values["speed"]
        build.chain.friction.append(FrictionTerm(place.tendon, stribeck_level, parameters))


@law
def stribeck_level(speed: float, torque: float, p: Sequence[float]) -> float:
    """Return the bound of the friction at a speed; Coulomb, static, Stribeck speed."""
    return p[0] + (p[1] - p[0]) * math.exp(-((speed / p[2]) ** 2))
