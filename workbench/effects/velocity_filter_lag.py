"""A measured velocity that is filtered more than the model knows."""

from __future__ import annotations

import numpy as np
import scipy

from workbench.models import Model

from .base import Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values, rows
from .response import Response, read_on

_NONE = 1e-9  # of a row: a lag of which a fit has left nothing


class VelocityFilterLag(Effect):
    """time_constant * dv/dt = w - v, v the measured velocity, which the controller uses."""

    name = "velocity_filter_lag"
    parameters = Parameters(
        Parameter("time_constant", "s", upper=0.5, starts=rows(0.2, 40.0, 12), example=0.008, linear=False)
    )
    stage = SignalStage.SENSOR
    words = Words(
        source="first-order low-pass of the drive's speed estimate; Ellis, Control System Design "
        "Guide, Ch. 9",
        shows="less damping of the loop at high frequency; measured velocity lags the rate of the measured "
        "position",
        reveal="a chirp or multisine beyond the filter's corner, with position and velocity logged",
        mujoco="filter of the velocity that is read",
    )
    search = Search(frf_signature=FrfSignature.DELAY, shared_by_design=True, hidden_state=True)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: the filtered velocity minus the velocity."""
        speed = motion.along(place)[1]
        change = lagged(speed, motion.step, shape["time_constant"]) - speed
        return Response(
            np.zeros((0, *motion.position.shape)),
            reading=read_on(place, np.zeros_like(speed), change, motion),
        )

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Lag of the sensor; lags of one sensor add up."""
        build.chain.sensors.lag[place.index] += values["time_constant"]


def lagged(values: np.ndarray, step: float, time_constant: float) -> np.ndarray:
    """Return rows (N,) after a first-order lag, exact for linear changes between rows, settled at first."""
    ratio = time_constant / step
    if ratio < _NONE:
        return values.copy()
    kept = np.exp(-1.0 / ratio)
    # y1 = kept y0 + (x1 - x0) (1 - ratio (1 - kept)) + x0 (1 - kept)
    rise = 1.0 - ratio * (1.0 - kept)
    start = values[0] - rise * values[0]
    return scipy.signal.lfilter([rise, 1.0 - kept - rise], [1.0, -kept], values, zi=[start])[0]
