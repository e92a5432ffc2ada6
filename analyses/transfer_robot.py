"""Differences of the study's virtual quadruped from its model, each of which can be switched on alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from transfer_drives import DriveSide, DriveTrain, drive_side

from workbench.mechanism import Ground
from workbench.rigs import HiddenEffect
from workbench.training.machine import LEGS, Machine
from workbench.training.own_plant import OwnPlant
from workbench.training.plant import Plant
from workbench.training.plants import FEET, SUBSTEP_S, ClosedChainPlant
from workbench.training.quadruped import FOOT_RADIUS
from workbench.training.robot import Robot as AsDrawn


@dataclass(frozen=True)
class Robot(AsDrawn):
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

    def plant(self, machine: Machine) -> Plant:
        """Return this robot's hardware."""
        return RobotPlant(machine, self) if machine.floating else OwnPlant(machine, self.hidden)

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


class RobotPlant(ClosedChainPlant):
    """Virtual hardware that walks, with its deviations.

    Args:
        machine: of kind ``quadruped``; tells the drives' inertia and damping.
        robot: what it has beyond `machine`.

    Raises:
        InputError: the machine's legs are not those of the reference, or drives cannot hide an effect here.
    """

    def __init__(self, machine: Machine, robot: Robot = IDEAL) -> None:
        ground = Ground(
            FEET, FOOT_RADIUS, robot.friction, robot.ground_stiffness, robot.ground_damping, robot.roughness
        )
        self._roughness, self._drives = robot.roughness, DriveTrain(_sides(machine, robot), SUBSTEP_S)
        super().__init__(machine, ground, self._drives.rotor.tolist(), self._drives.damping.tolist())
        for mass, at in ((robot.payload, (0.0,) * 3), (robot.trunk_mass, robot.trunk_at)):
            if mass:
                self.chain.load(mass, at)

    def reset(self, drives: np.ndarray, height: float) -> None:
        """Set it at rest at drive positions (n,), its base level at a height above the tiles [m]."""
        super().reset(drives, height + self._roughness)
        self._drives.reset(drives)

    def passed(self, torque: np.ndarray) -> np.ndarray:
        """Return the torque that the drives pass on to the links, (n,) [N m]."""
        return self._drives.advance(torque, *super().motion())

    def motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Return angles and speeds of the rotors, (n,) each."""
        return self._drives.motion(*super().motion())


def _sides(machine: Machine, robot: Robot) -> list[DriveSide]:
    """Every drive with its own inertia, damping and friction and what is hidden in it; not in abductions."""
    own, nominal = machine.model.actuators, DriveSide()
    leg = []
    for axis, inertia, damping in zip(machine.model.axes, own.inertia, own.damping, strict=True):
        side = drive_side(robot.hidden, axis)
        more = side.inertia - nominal.inertia, side.damping - nominal.damping
        rubs = side.friction + robot.drive_friction
        leg.append(replace(side, inertia=inertia + more[0], damping=damping + more[1], friction=rubs))
    abduction = DriveSide(own.inertia[0], own.damping[0], friction=robot.drive_friction)
    return [abduction, *leg] * len(LEGS)
