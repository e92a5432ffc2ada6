"""Coulomb friction at a drive or a pin."""

from __future__ import annotations

from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .corrected import AtJoint, down_to, own_dry_friction
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response, single, smooth_sign
from .setting import SLIDING_SPEED


class CoulombFriction(Effect):
    """torque = -f sign(w), f the parameter `torque`; the axis sticks while all other torques stay below f."""

    name = "coulomb_friction"
    parameters = Parameters(
        Parameter(
            "torque",
            "N*m",
            about="added to what the model has",
            within=down_to(own_dry_friction),
            example=0.3,
        ),
        settles=(SLIDING_SPEED,),
    )
    stage = SignalStage.FRICTION
    locations = ("actuator", "joint")
    corrects = AtJoint("frictionloss", "torque", own_dry_friction, power=1, called="dry friction")
    words = Words(
        source="Coulomb 1785; Armstrong-Helouvry et al., Automatica 30(7), 1994",
        shows="torque residual steps at each reversal, odd in speed, independent of its size",
        reveal="a slow triangular motion with many reversals",
        mujoco="native: friction loss of the axis's tendon",
    )
    search = Search(frf_signature=FrfSignature.ODD, basic=True)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: minus the sign of the speed."""
        return Response(single(place, -smooth_sign(motion.sliding(place)), motion)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Friction loss of the tendon."""
        build.spec.tendon(place.tendon).frictionloss += values["torque"]
