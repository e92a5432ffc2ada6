"""A loop whose gains are not those that the recording states."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import Door, Effect, Parameter
from .chain import Build
from .motion import Motion
from .response import Response


class ControllerGainError(Effect):
    """torque = s_p kp (q_ref - q) + s_d kd (w_ref - w) on one axis of the controller's coordinates.

    Of a cascade, s_p scales the gain of its position loop and s_d that of its velocity loop.
    """

    name = "controller_gain_error"
    parameters = (
        Parameter("kp_scale", "1", upper=10.0, neutral=1.0),
        Parameter("kd_scale", "1", upper=10.0, neutral=1.0),
    )
    door = Door.CONTROLLER
    source = "PD law of the loop; units, scaling or rounding of gains in the drive"
    shows = "torque command not what the stated gains make of the logged motion"
    reveal = "steps of the reference, with command, position and velocity logged"
    mujoco = "gains of the controller that runs with the model"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Once a controller axis."""
        return not model.has(self.name, key.axis)

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """Two columns: what each gain asks for; coefficients are the scales minus one."""
        assert place is not None
        shares = motion.law(place.index)
        return Response(np.zeros_like(shares), commands=shares)

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """The scales' bounds, less one."""
        return (
            np.array([p.lower - 1.0 for p in self.parameters]),
            np.array([p.upper - 1.0 for p in self.parameters]),
        )

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """Scales are one plus the coefficients."""
        position, rate = map(float, coefficients)
        return {"kp_scale": 1.0 + position, "kd_scale": 1.0 + rate}

    def to_coefficients(self, values: Mapping[str, float]) -> tuple[np.ndarray, dict[str, float]]:
        """The coefficients are the scales minus one."""
        return np.array([values["kp_scale"] - 1.0, values["kd_scale"] - 1.0]), {}

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Scales of the loop's gains."""
        assert place is not None
        build.chain.kp_scale[place.index] *= values["kp_scale"]
        build.chain.kd_scale[place.index] *= values["kd_scale"]
