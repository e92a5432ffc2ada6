"""A drive that gives less torque than the model believes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from workbench.models import Model

from .base import Effect, SignalStage, Words
from .chain import Build
from .motion import Motion, at_tap
from .parameter import Parameter, Parameters, Place, Values
from .response import Response


def _ceilings(motions: Sequence[Motion], model: Model, place: Place) -> Sequence[float]:
    """Ceilings from a tenth of the highest torque to all of it; the likely one if it was measured."""
    asked, _, measured = at_tap(motions, place.index)
    top = float(np.abs(asked).max()) + 1e-9
    if measured is None:
        return [*(top * np.geomspace(0.1, 0.97, 16))]
    tried = (float(np.abs(measured).max()) + 1e-9) * np.geomspace(0.03, 1.0, 150)

    def off(limit: float) -> float:
        return float(np.sum((np.clip(asked, -limit, limit) - measured) ** 2))

    best = int(np.argmin([off(v) for v in tried]))
    # where the loop is at its limit for long, a start that is a per cent off leads a fit astray
    around = tried[max(best - 1, 0)], tried[min(best + 1, len(tried) - 1)]
    exact = minimize_scalar(off, bounds=around, method="bounded", options={"xatol": 1e-5 * tried[best]})
    return [float(exact.x)]


class TorqueSaturation(Effect):
    """torque clipped to [-limit, limit]; the measured torque shows it."""

    name = "torque_saturation"
    parameters = Parameters(
        Parameter(
            "limit",
            "N*m",
            lower=1e-6,
            starts=_ceilings,
            blur=lambda values, position, torque: 0.1 * torque,
            about="the model may have a limit too; the lower one counts",
            example=0.6,
            linear=False,
        )
    )
    stage = SignalStage.COMMAND
    words = Words(
        source="current limit of drives, tau = k_t i; Astrom and Hagglund, Advanced PID Control, Ch. 3",
        shows="measured torque has a ceiling that the command exceeds, at every speed",
        reveal="steps or chirps whose command goes well beyond the ceiling, at several speeds",
        mujoco="native: force range of the actuator",
    )

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: what the ceiling takes away."""
        limit = motion.line.limit.copy()
        limit[place.index] = min(limit[place.index], shape["limit"])
        return Response.passed(motion, replace(motion.line, limit=limit))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Limit of the chain."""
        build.chain.limit[place.index] = min(build.chain.limit[place.index], values["limit"])
