"""Differences of a virtual quadruped from its model, each of which can be switched on alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.rigs import HiddenEffect


@dataclass(frozen=True)
class Robot:
    """Deviations of the hardware; none by default.

    Attributes:
        hidden: effects in the hip and knee drives of every leg.
        drive_friction: dry friction in all twelve drives, abductions too [N m].
        friction: coefficient of the ground.
        ground_stiffness: of a contact [N/m]; None: as hard as the solver has it.
        ground_damping: of a contact that has a stiffness [N s/m]; None: Drake's own.
        roughness: height up to which the ground's tiles stand out [m].
        payload: mass at the trunk's centre, which the simulator is told [kg].
        trunk_mass: mass at `trunk_at` that nobody is told [kg].
        trunk_at: in the trunk's frame (3,) [m].
        latency_steps: control steps by which actions come later than the model says.
        gyro_bias: of the angular velocity (3,) [rad/s].
        tilt_bias: rotation of the measured gravity about x and y (2,) [rad].
        imu_steps: control steps by which the inertial unit is late.
        no_load_speed: of a drive, at which it gives no torque [rad/s]; infinite: no such limit.
        sag: share of no-load speed and largest torque that is lost with each kW of all drives together.
    """

    hidden: tuple[HiddenEffect, ...] = ()
    drive_friction: float = 0.0
    friction: float = 0.8
    ground_stiffness: float | None = None
    ground_damping: float | None = None
    roughness: float = 0.0
    payload: float = 0.0
    trunk_mass: float = 0.0
    trunk_at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    latency_steps: int = 0
    gyro_bias: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tilt_bias: tuple[float, float] = (0.0, 0.0)
    imu_steps: int = 0
    no_load_speed: float = np.inf
    sag: float = 0.0

    def delivered(self, torque: np.ndarray, speed: np.ndarray, limit: np.ndarray) -> np.ndarray:
        """Return the torque (n,) [N m] that drives give for a command, at speeds (n,) [rad/s].

        Torque along the motion falls in a line from twice the largest at rest to zero at the no-load speed;
        the battery's voltage moves both. `limit` (n,) is the largest torque [N m].
        """
        if np.isinf(self.no_load_speed):
            return torque
        power = 1e-3 * float(np.maximum(torque * speed, 0.0).sum())  # kW
        left = max(0.0, 1.0 - self.sag * power)
        most = left * 2.0 * limit * np.maximum(0.0, 1.0 - np.abs(speed) / (left * self.no_load_speed + 1e-9))
        most = np.minimum(left * limit, most)
        driving = torque * speed > 0.0
        return np.where(driving, np.clip(torque, -most, most), torque)

    def felt(
        self, gravity: np.ndarray, angular: np.ndarray, before: Sequence[tuple[np.ndarray, np.ndarray]]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the reading of the inertial unit without noise: gravity direction and angular velocity, (1,
        3) each.

        `before`: true values of earlier control steps, the last one first.
        """
        if self.imu_steps and before:
            gravity, angular = before[min(self.imu_steps, len(before)) - 1]
        about_x, about_y = self.tilt_bias
        x, y, z = gravity[0]
        turned = np.array([[x + about_y * z, y - about_x * z, z - about_y * x + about_x * y]])
        return turned, angular + np.array(self.gyro_bias)


IDEAL = Robot()
