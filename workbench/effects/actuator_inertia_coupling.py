"""S3N-Act: actuator inertia and damping pulled back through the coordinate change."""

from __future__ import annotations

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, axis_tendon

from .base import WHOLE, Search, Words
from .chain import Build
from .motion import Motion
from .parameter import Place, Values
from .response import Response
from .structural import Structural


class ActuatorInertiaCoupling(Structural):
    """Drives' inertia J_i and damping B_i at the joints: J^T diag(J_i) J, not diag(J_i), and so for B_i."""

    name = "actuator_inertia_coupling"
    locations = WHOLE
    words = Words(
        source="paper, Eqs. 10 to 14",
        shows="inertia coupling between the axes at every posture; FRF off the diagonal",
        reveal="sum- and difference-mode multisines about one posture",
        mujoco="native: armature and damping of the axes' tendons instead of the joints'",
        needs="drives with inertia that move more than their own joints",
    )
    search = Search(basic=True)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Where a drive moves more than its own joint."""
        moves_more = not np.array_equal(model.transmission, np.eye(model.size))
        return moves_more and any(model.actuators.inertia) and not model.has(self.name)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: diag at the drives minus diag at the joints, both from the actuators."""
        back = np.linalg.inv(model.transmission)
        total = np.zeros_like(motion.acceleration)
        for diagonal, rate in (
            (model.actuators.inertia, motion.acceleration),
            (model.actuators.damping, motion.velocity),
        ):
            at_drives = rate * np.array(diagonal)
            at_joints = (rate @ back.T * np.array(diagonal)) @ back
            total -= at_drives - at_joints
        return Response(np.zeros((0, *total.shape)), offset=total)

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Move the diagonal from the joints to the drives' tendons."""
        drives = zip(model.joints, model.actuators.inertia, model.actuators.damping, strict=True)
        for index, (name, inertia, damping) in enumerate(drives):
            joint, tendon = build.spec.joint(name), build.spec.tendon(axis_tendon(index))
            joint.armature = max(joint.armature - inertia, 0.0)
            joint.damping[0] = max(joint.damping[0] - damping, 0.0)
            tendon.armature += inertia
            tendon.damping[0] += damping
