"""A motor whose torque constant falls as it heats up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import Effect, Search, SignalStage, Words
from .chain import Build
from .lag import heat
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response, single


def _times(motions: Sequence[Motion], model: Model, place: Place) -> np.ndarray:
    """Time constants from a hundredth of the longest recording to three of it."""
    return max(m.step * len(m.position) for m in motions) * np.geomspace(0.01, 3.0, 8)


class ThermalDerating(Effect):
    """true torque = max(0, 1 - coefficient * y) u, time_constant * dy/dt = u^2 - y, u the measured torque;
    y = 0 at the start.
    """

    name = "thermal_derating"
    parameters = Parameters(
        Parameter("coefficient", "1/(N*m)^2", example=0.6),
        Parameter("time_constant", "s", lower=1e-3, starts=_times, example=1.0, linear=False),
    )
    stage = SignalStage.MOTOR
    words = Words(
        source="copper loss heats magnets, whose flux falls; Hendershot and Miller, Permanent-Magnet "
        "Motors, Ch. 7",
        shows="torque residual proportional to the motor torque, growing after each hard stretch",
        reveal="a hard stretch longer than the motor's time constant, then the same slow motion as before",
        mujoco="gain of the actuator that depends on a filtered square of its torque: a state",
    )
    search = Search(shared_by_design=True)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Once a drive: two time constants would need two temperatures."""
        return not model.has(self.name, key.axis)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: minus the torque times its filtered square."""
        torque = motion.torque[:, place.index]
        lost = torque * heat(torque, motion.step, shape["time_constant"])
        return Response(single(place, -motion.gain[:, place.index] * lost, motion)[None])

    def before(self, motion: Motion, place: Place, values: Values) -> Motion:
        """With a motor that stays cold."""
        warm = heat(motion.torque[:, place.index], motion.step, values["time_constant"])
        gain = motion.gain.copy()
        gain[:, place.index] /= np.maximum(1.0 - values["coefficient"] * warm, 1e-3)
        return replace(motion, gain=gain)

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Derating of the chain."""
        build.chain.heating[place.index] = values["coefficient"]
        build.chain.heat_time[place.index] = values["time_constant"]
