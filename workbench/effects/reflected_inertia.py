"""More rotor inertia behind the gear than the model has."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.core import EffectKey
from workbench.models import JointNumber, Model, Placement, rotors, turned_joint

from .base import Door, Effect, Parameter
from .chain import Build
from .motion import Motion
from .response import Response, single


class ReflectedInertia(Effect):
    """torque = -J a on the drive, J = N^2 J_m added (paper, Eq. 7)."""

    name = "reflected_inertia"
    parameters = (Parameter("inertia", "kg*m^2", about="added to what the model has"),)
    door = Door.MECHANISM
    depends_on = ("acceleration",)
    basic = True
    of_a_make = True
    source = "paper, Eqs. 7 and 9"
    shows = "torque residual proportional to the drive's acceleration; FRF magnitude at high frequency"
    reveal = "a fast chirp of this axis about one posture, the other axes held"
    mujoco = "native: armature of the axis's tendon"

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column: minus the acceleration."""
        assert place is not None
        _, _, acceleration = motion.along(place)
        return Response(single(place, -acceleration, motion)[None])

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """The drive's own inertia may turn out smaller than stated, but stays above a tenth of it in all."""
        assert place is not None
        own, key = rotors(model)[0][place.index], EffectKey(self.name, model.axes[place.index])
        added = sum(e.values["inertia"] for e in model.effects if e.key == key)
        return np.array([-max(0.9 * own + added, 0.0)]), np.array([np.inf])

    def model_value(self, model: Model, place: Placement | None) -> float:
        """What the model states of the drive's own, and what was added."""
        assert place is not None
        own = float(rotors(model)[0][place.index])
        return own + sum(e.values["inertia"] for e in model.effects if self.sits(e.key, model, place))

    def in_file(
        self, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> JointNumber | None:
        """Armature of the joint."""
        assert place is not None
        turned = turned_joint(model, place)
        return turned and JointNumber(turned[0], "armature", values["inertia"] * turned[1] ** 2)

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Armature of the tendon; what is less than that has, of the joint that holds the rotor."""
        assert place is not None
        tendon = build.spec.tendon(place.tendon)
        whole = tendon.armature + values["inertia"]
        tendon.armature = max(whole, 0.0)
        if whole < 0.0:  # MuJoCo has no negative armature
            name, ratio = _holder(build, model, place)
            joint = build.spec.joint(name)
            joint.armature = max(joint.armature + whole * ratio**2, 0.0)


def _holder(build: Build, model: Model, place: Placement) -> tuple[str, float]:
    """Joint that holds a drive's rotor, and how far the rotor turns with it: its own, or the serial one."""
    turned = build.rows[place.tendon]
    return next(iter(turned.items())) if len(turned) == 1 else (model.joints[place.index], 1.0)
