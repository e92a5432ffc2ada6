"""Coulomb friction at a drive or a pin."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.models import JointNumber, Model, Placement, own_friction, turned_joint

from .base import Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response, single, smooth_sign


class CoulombFriction(Effect):
    """torque = -f sign(w); sticks where the other torques stay below f."""

    name = "coulomb_friction"
    parameters = (Parameter("torque", "N*m", about="added to what the model has"),)
    door = Door.FRICTION
    depends_on = ("speed",)
    basic = True
    dry = True
    locations = ("actuator", "joint")
    of_a_make = True
    trace = Trace.ODD
    source = "Coulomb 1785; Armstrong-Helouvry et al., Automatica 30(7), 1994"
    shows = "torque residual steps at each reversal, odd in speed, independent of its size"
    reveal = "a slow triangular motion with many reversals"
    mujoco = "native: friction loss of the axis's tendon"

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column: minus the sign of the speed."""
        assert place is not None
        _, speed, _ = motion.along(place)
        return Response(single(place, -smooth_sign(speed), motion)[None])

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """Friction that the model has there may turn out smaller, down to none."""
        return np.array([-self.model_value(model, place)]), np.array([np.inf])

    def model_value(self, model: Model, place: Placement | None) -> float:
        """``frictionloss`` that the model's file states there, and what was added."""
        assert place is not None
        every = (*own_friction(model), *model.effects)
        return sum(e.values["torque"] for e in every if self.sits(e.key, model, place))

    def in_file(
        self, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> JointNumber | None:
        """Friction loss of the joint."""
        assert place is not None
        turned = turned_joint(model, place)
        return turned and JointNumber(turned[0], "frictionloss", values["torque"] * abs(turned[1]))

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Friction loss of the tendon."""
        assert place is not None
        build.spec.tendon(place.tendon).frictionloss += values["torque"]
