"""Friction that grows with the torque that a gear transmits."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build, FrictionTerm
from .law import law
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response, single, smooth_sign
from .setting import SLIDING_SPEED


class LoadDependentFriction(Effect):
    """torque = -(f + ratio * |u|) sign(w), f the parameter `torque`, u the torque of the axis's motor."""

    name = "load_dependent_friction"
    parameters = Parameters(
        Parameter("torque", "N*m", example=0.1),
        Parameter("ratio", "1", upper=0.9, example=0.15),
        settles=(SLIDING_SPEED,),
    )
    stage = SignalStage.FRICTION
    locations = ("actuator", "joint")
    words = Words(
        source="Hamon, Gautier, Garrec, New dry friction model with load- and velocity-dependence, ICRA 2010",
        shows="torque residual steps at each reversal, by more at higher motor torque",
        reveal="slow motion with many reversals, once with and once without a load",
        mujoco="torque function of the motor torque: the level of the axis's friction loss, step by step",
    )
    search = Search(contains=("coulomb_friction",), depends_on=("load",), frf_signature=FrfSignature.ODD)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Two columns: minus the sign of the speed, by itself and times the size of the motor torque."""
        sign = smooth_sign(motion.sliding(place))
        load = np.abs(motion.gain * motion.torque)[:, place.index]
        return Response(np.stack([single(place, row, motion) for row in (-sign, -load * sign)]))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A friction level of the tendon that depends on the motor torque."""
        parameters = values["torque"], values["ratio"]
        build.chain.friction.append(FrictionTerm(place.tendon, loaded_level, parameters))


@law
def loaded_level(speed: float, torque: float, p: Sequence[float]) -> float:
    """Return the bound of the friction under a motor torque; constant, ratio."""
    return p[0] + p[1] * abs(torque)
