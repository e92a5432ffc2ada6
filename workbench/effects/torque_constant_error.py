"""The torque constant is not the nominal one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response, single


class TorqueConstantError(Effect):
    """true torque = gain * measured torque, since the measured one is current times the nominal constant."""

    name = "torque_constant_error"
    parameters = (Parameter("gain", "1", lower=0.05, upper=20.0, neutral=1.0),)
    door = Door.MOTOR
    of_a_make = True
    trace = Trace.GAIN
    source = "motor torque constant, tau = k_t i; spread of magnets, temperature, saturation"
    shows = "torque residual proportional to the motor torque at every frequency"
    reveal = "a known weight held at several positions"
    mujoco = "gain of the actuator"

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column: the measured torque; its coefficient is the gain minus one."""
        assert place is not None
        return Response(single(place, motion.torque[:, place.index], motion)[None])

    def bounds(self, model: Model, place: Placement | None) -> tuple[np.ndarray, np.ndarray]:
        """The gain's bounds, less one."""
        gain = self.parameters[0]
        return np.array([gain.lower - 1.0]), np.array([gain.upper - 1.0])

    def to_parameters(self, coefficients: np.ndarray, shape: Mapping[str, float]) -> dict[str, float]:
        """Gain is one plus the coefficient."""
        return {"gain": 1.0 + float(coefficients[0])}

    def to_coefficients(self, values: Mapping[str, float]) -> tuple[np.ndarray, dict[str, float]]:
        """The coefficient is the gain minus one."""
        return np.array([values["gain"] - 1.0]), {}

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Gain of the chain."""
        assert place is not None
        build.chain.gain[place.index] *= values["gain"]
