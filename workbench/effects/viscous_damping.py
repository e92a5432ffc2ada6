"""Viscous damping at a drive or a pin."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.models import JointNumber, Model, Placement, rotors, turned_joint

from .base import Door, Effect, Parameter
from .chain import Build
from .motion import Motion
from .response import Response, single


class ViscousDamping(Effect):
    """torque = -d w, added to the damping that the model has."""

    name = "viscous_damping"
    parameters = (Parameter("damping", "N*m*s/rad", about="added to what the model has"),)
    door = Door.FRICTION
    depends_on = ("speed",)
    basic = True
    locations = ("actuator", "joint")
    of_a_make = True
    source = "Newtonian lubricant film; Armstrong-Helouvry et al., Automatica 30(7), 1994"
    shows = "torque residual odd and linear in speed; FRF magnitude at low frequency"
    reveal = "steady runs at several speeds in both directions"
    mujoco = "native: damping of the axis's tendon"

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column: minus the speed."""
        assert place is not None
        _, speed, _ = motion.along(place)
        return Response(single(place, -speed, motion)[None])

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """Damping that the model has there may turn out smaller, down to none."""
        return np.array([-self.model_value(model, place)]), np.array([np.inf])

    def model_value(self, model: Model, place: Placement | None) -> float:
        """What the model states of the drive's own, and what was added."""
        assert place is not None
        own = float(rotors(model)[1][place.index]) if place.location == "actuator" else 0.0
        return own + sum(e.values["damping"] for e in model.effects if self.sits(e.key, model, place))

    def in_file(
        self, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> JointNumber | None:
        """Damping of the joint."""
        assert place is not None
        turned = turned_joint(model, place)
        return turned and JointNumber(turned[0], "damping", values["damping"] * turned[1] ** 2)

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Damping of the tendon."""
        assert place is not None
        build.spec.tendon(place.tendon).damping[0] += values["damping"]
