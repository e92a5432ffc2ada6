"""A spring beside the drive or across the pin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from workbench.models import JointNumber, Model, Placement, turned_joint

from .base import INF, Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response, single

_FAR = 10.0  # spans of the motion: the torque of a spring that rests beyond hardly changes


class ParallelSpring(Effect):
    """torque = -k (q - q0)."""

    name = "parallel_spring"
    parameters = (
        Parameter("stiffness", "N*m/rad"),
        Parameter("rest", "rad", lower=-INF),
    )
    door = Door.MECHANISM
    depends_on = ("position",)
    contains = ("torque_bias",)
    locations = ("actuator", "joint")
    trace = Trace.EVEN
    source = "Hooke 1678; parallel elastic actuation"
    shows = "torque residual linear in position at every speed; FRF magnitude at low frequency"
    reveal = "a slow sweep over the widest range of positions"
    mujoco = "native: stiffness of the axis's tendon"

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """Two columns: minus the position, and one; the coefficients are k and k q0."""
        assert place is not None
        position, _, _ = motion.along(place)
        rows = (-position, np.ones_like(position))
        return Response(np.stack([single(place, row, motion) for row in rows]))

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """Stiffness, and the rest position where its torque vanishes."""
        stiffness, moment = map(float, coefficients)
        return {"stiffness": stiffness, "rest": moment / stiffness if stiffness > 1e-12 else 0.0}

    def to_coefficients(self, values: Mapping[str, float]) -> tuple[np.ndarray, dict[str, float]]:
        """k and k q0."""
        return np.array([values["stiffness"], values["stiffness"] * values["rest"]]), {}

    def differs(
        self, motions: Sequence[Motion], place: Placement | None, values: Mapping[str, float]
    ) -> bool:
        """Where it does not rest so far away that it is a constant torque."""
        assert place is not None
        positions = np.concatenate([m.along(place)[0] for m in motions])
        return bool(abs(values["rest"] - positions.mean()) < _FAR * np.ptp(positions))

    def in_file(
        self, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> JointNumber | None:
        """Stiffness of the joint, and where it rests."""
        assert place is not None
        turned = turned_joint(model, place)
        if turned is None:
            return None
        joint, ratio = turned
        return JointNumber(joint, "stiffness", values["stiffness"] * ratio**2, values["rest"] / ratio)

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Stiffness of the tendon; a second spring on the same tendon adds to the first."""
        assert place is not None
        tendon = build.spec.tendon(place.tendon)
        before = float(tendon.stiffness[0])
        rest = float(tendon.springlength[0]) if before else 0.0
        after = before + values["stiffness"]
        if after > 0:
            tendon.stiffness[0] = after
            tendon.springlength = np.full(2, (before * rest + values["stiffness"] * values["rest"]) / after)
