"""Positions and velocities that reach log and loop late."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from workbench.models import Model, Placement

from .base import Door, Effect, Parameter, Trace
from .chain import Build
from .motion import Motion
from .response import Response


class SensorDelay(Effect):
    """measured position and velocity (t) = true ones (t - T), on all axes; the loop reads the same."""

    name = "sensor_delay"
    parameters = (Parameter("time", "s", upper=0.2),)
    nonlinear = ("time",)
    twins_by_command = ("command_delay",)
    by_runs = True
    door = Door.SENSOR
    axes = "all"
    needs_the_past = True
    trace = Trace.DELAY
    source = "transport delay of sensors and bus"
    shows = "motion late against the measured torque; FRF phase falls with frequency, the torque's does not"
    reveal = "a multisine up to a quarter of the control rate, with measured torque"
    mujoco = "native: delay of the sensors"

    def shapes(
        self, motions: Sequence[Motion], model: Model, place: Placement | None
    ) -> Sequence[Mapping[str, float]]:
        """Delays from a tenth of a row to some rows beyond the controller's usual step."""
        step = motions[0].step
        return [{"time": float(t)} for t in np.geomspace(0.1 * step, max(12.0 * step, 0.012), 12)]

    def response(
        self, motion: Motion, model: Model, place: Placement | None, shape: Mapping[str, float]
    ) -> Response:
        """No free coefficient: what was so long ago minus what is."""
        time = motion.step * np.arange(len(motion.position))
        then = np.maximum(time - shape["time"], 0.0)
        before = CubicHermiteSpline(time, motion.position, motion.velocity)(then)
        # torques jump, so that speeds have kinks and lines follow them best
        columns = motion.velocity.T
        slower = np.stack([np.interp(then, time, speed) for speed in columns], axis=1)
        pair = before - motion.position, slower - motion.velocity
        return Response(np.zeros((0, *motion.position.shape)), reading=np.stack(pair))

    def install(
        self, build: Build, model: Model, place: Placement | None, values: Mapping[str, float]
    ) -> None:
        """Delay of the sensors."""
        build.chain.sensors.delay_s += values["time"]
