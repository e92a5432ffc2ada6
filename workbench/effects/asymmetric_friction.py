"""Friction that differs by direction: worn screws, preloaded gears, seals."""

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


class AsymmetricFriction(Effect):
    """torque = -(torque_positive + damping_positive * w) for w > 0,
    and torque_negative - damping_negative * w for w < 0.
    """

    name = "asymmetric_friction"
    parameters = Parameters(
        Parameter("damping_positive", "N*m*s/rad", example=0.1),
        Parameter("damping_negative", "N*m*s/rad", example=0.02),
        Parameter("torque_positive", "N*m", example=0.2),
        Parameter("torque_negative", "N*m", example=0.4),
        settles=(SLIDING_SPEED,),
    )
    stage = SignalStage.FRICTION
    locations = ("actuator", "joint")
    words = Words(
        source="Janot, Gautier, Brunot, Workshop on Nonlinear System Identification Benchmarks, 2019",
        shows="torque residual against speed has a different slope or step in each direction",
        reveal="steady runs at the same speeds in both directions",
        mujoco="torque function of the speed: the level of the axis's friction loss, step by step",
    )
    # twins: unequal Coulomb torques are equal ones and a constant torque
    search = Search(
        contains=("viscous_damping", "coulomb_friction"),
        twins=("torque_bias",),
        frf_signature=FrfSignature.EVEN,
    )

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """Four columns, each nonzero in one direction only."""
        _, speed, _ = motion.along(place)
        sign = smooth_sign(motion.sliding(place))
        up, down = 0.5 * (1.0 + sign), 0.5 * (1.0 - sign)
        rows = (-speed * up, -speed * down, -np.maximum(sign, 0.0), -np.minimum(sign, 0.0))
        return Response(np.stack([single(place, row, motion) for row in rows]))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A friction level of the tendon that depends on the speed."""
        parameters = tuple(values[p.name] for p in self.parameters)
        build.chain.friction.append(FrictionTerm(place.tendon, asymmetric_level, parameters))


@law
def asymmetric_level(speed: float, torque: float, p: Sequence[float]) -> float:
    """Return the bound of the friction at a speed; damping and Coulomb torque, each forwards and
    backwards.
    """
    return p[2] + p[0] * speed if speed > 0.0 else p[3] - p[1] * speed
