"""A motor whose torque constant falls as it heats up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model, Placement

from .base import Door, Effect, Parameter
from .chain import Build
from .lag import heat
from .motion import Motion
from .response import Response, single


class ThermalDerating(Effect):
    """true torque = max(0, 1 - c y) u, T dy/dt = u^2 - y, u the measured torque; cold at the start."""

    name = "thermal_derating"
    parameters = (
        Parameter("coefficient", "1/(N*m)^2"),
        Parameter("time_constant", "s", lower=1e-3),
    )
    nonlinear = ("time_constant",)
    door = Door.MOTOR
    tier = 1
    of_a_make = True
    source = (
        "copper loss heats magnets, whose flux falls; Hendershot and Miller, Permanent-Magnet Motors, Ch. 7"
    )
    shows = "torque residual proportional to the motor torque, growing after each hard stretch"
    reveal = "a hard stretch longer than the motor's time constant, then the same slow motion as before"
    mujoco = "gain of the actuator that depends on a filtered square of its torque: a state"

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Once a drive: two time constants would need two temperatures."""
        return not model.has(self.name, key.axis)

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """Time constants from a hundredth of the longest recording to three of it."""
        longest = max(m.step * len(m.position) for m in motions)
        return [{"time_constant": float(t)} for t in longest * np.geomspace(0.01, 3.0, 8)]

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """One column: minus the torque times its filtered square."""
        assert place is not None
        torque = motion.torque[:, place.index]
        lost = torque * heat(torque, motion.step, shape["time_constant"])
        return Response(single(place, -motion.gain[:, place.index] * lost, motion)[None])

    def before(self, motion: Motion, place: Placement | None, values: Mapping[str, float]) -> Motion:
        """With a motor that stays cold."""
        assert place is not None
        warm = heat(motion.torque[:, place.index], motion.step, values["time_constant"])
        gain = motion.gain.copy()
        gain[:, place.index] /= np.maximum(1.0 - values["coefficient"] * warm, 1e-3)
        return replace(motion, gain=gain)

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Derating of the chain."""
        assert place is not None
        build.chain.heating[place.index] = values["coefficient"]
        build.chain.heat_time[place.index] = values["time_constant"]
