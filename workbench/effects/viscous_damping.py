"""Viscous damping at a drive or a pin."""

from __future__ import annotations

from workbench.models import Model, Placement, rotors

from .base import Effect, Search, SignalStage, Words
from .chain import Build
from .corrected import AtJoint, added, down_to
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response, single


def _own(model: Model, place: Placement) -> float:
    """What the model states of the drive's own, and what was added."""
    own = float(rotors(model)[1][place.index]) if place.location == "actuator" else 0.0
    return own + added("viscous_damping", "damping", model, place)


class ViscousDamping(Effect):
    """torque = -damping * w, added to the damping that the model has."""

    name = "viscous_damping"
    parameters = Parameters(
        Parameter(
            "damping", "N*m*s/rad", about="added to what the model has", within=down_to(_own), example=0.15
        )
    )
    stage = SignalStage.FRICTION
    locations = ("actuator", "joint")
    corrects = AtJoint("damping", "damping", _own, called="damping")
    words = Words(
        source="Newtonian lubricant film; Armstrong-Helouvry et al., Automatica 30(7), 1994",
        shows="torque residual odd and linear in speed; FRF magnitude is wrong at low frequency",
        reveal="steady runs at several speeds in both directions",
        mujoco="native: damping of the axis's tendon",
    )
    search = Search(basic=True)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: minus the speed."""
        _, speed, _ = motion.along(place)
        return Response(single(place, -speed, motion)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Damping of the tendon."""
        build.spec.tendon(place.tendon).damping[0] += values["damping"]
