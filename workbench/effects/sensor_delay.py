"""Positions and velocities that reach log and loop late."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from workbench.models import Model

from .base import WHOLE, Effect, FrfSignature, Search, SignalStage, Words
from .chain import Build
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values, rows
from .response import Response


class SensorDelay(Effect):
    """measured position(t) = true position(t - time) on all axes, and the same for the velocity;
    the controller uses these.
    """

    name = "sensor_delay"
    parameters = Parameters(
        Parameter("time", "s", upper=0.2, starts=rows(0.1, 12.0, 12), example=0.003, linear=False)
    )
    stage = SignalStage.SENSOR
    locations = WHOLE
    words = Words(
        source="transport delay of sensors and bus",
        shows="motion lags the measured torque; FRF phase falls with frequency, the torque's does not",
        reveal="a multisine up to a quarter of the control rate, with measured torque",
        mujoco="native: delay of the sensors",
    )
    search = Search(frf_signature=FrfSignature.DELAY, hidden_state=True)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: what was so long ago minus what is."""
        time = motion.step * np.arange(len(motion.position))
        then = np.maximum(time - shape["time"], 0.0)
        before = CubicHermiteSpline(time, motion.position, motion.velocity)(then)
        # torques jump, so that speeds have kinks and lines follow them best
        columns = motion.velocity.T
        slower = np.stack([np.interp(then, time, speed) for speed in columns], axis=1)
        pair = before - motion.position, slower - motion.velocity
        return Response(np.zeros((0, *motion.position.shape)), reading=np.stack(pair))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Delay of the sensors."""
        build.chain.sensors.delay_s += values["time"]
