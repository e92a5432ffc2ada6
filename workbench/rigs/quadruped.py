"""The reference quadruped as virtual hardware: twelve drives, four loops, a trunk and a ground, in Drake."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RotationMatrix

from workbench.core import Mechanism, SimulationError
from workbench.core.paths import closed_chain_file
from workbench.mechanism import DiscreteChain, Ground

from .live import Look
from .machine import ACTUATOR_DAMPING, ACTUATOR_INERTIA, TORQUE_LIMIT
from .virtual_leg import Sensors

LEGS = ("fl", "fr", "rl", "rr")
ROW = 0.5e-3  # s, one step of Drake
_FOOT, _FRICTION = 0.02, 0.8  # m; dry, with the ground
_STAND = (0.0, -0.75, 0.45)  # rad, of a leg's drives, in which it stands
_DROP = 0.005  # m that it is let down from
GYRO_NOISE, GRAVITY_NOISE, FORCE_NOISE = 0.02, 0.005, 0.01  # rad/s and shares of g: of a common unit
_G = 9.81  # m/s^2


def quadruped_mechanism() -> Mechanism:
    """Return the reference quadruped with abduction: 12 drives, four loops."""
    own = ("abduction", "hip", "crank_pin"), ("abduction", "hip", "knee")
    drives, joints = (tuple(f"{leg}_{name}" for leg in LEGS for name in names) for names in own)
    loops = tuple((f"{leg}_coupler_end", f"{leg}_rear_arm_end") for leg in LEGS)
    return Mechanism(closed_chain_file("quadruped_abduction"), drives, joints, loops, foot="fl_foot")


class LiveQuadruped:
    """Twelve motors, abduction, hip and knee of each leg, and an inertial unit in the trunk; see `Plant`.

    At first a stand holds trunk and legs where the robot will stand; whoever wants it to move lets it go.

    Args:
        seed: of the sensors' noise.
        sensors: of the drives.
        row: one step of Drake [s].

    Attributes:
        held: whether the stand holds it.
    """

    axes = 12

    def __init__(self, seed: int = 0, sensors: Sensors | None = None, row: float = ROW) -> None:
        self.held, self._sensors, self._row = True, sensors or Sensors(), row
        self._generator = np.random.default_rng([seed, 43])
        ground = Ground(tuple(f"{leg}_foot" for leg in LEGS), _FOOT, _FRICTION)
        inertia, damping = [ACTUATOR_INERTIA] * 12, [ACTUATOR_DAMPING] * 12
        self._chain = DiscreteChain(quadruped_mechanism(), inertia, damping, row, ground)
        level = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
        self._chain.reset(np.tile(_STAND, 4), base=level)
        lowest = min(float(self._chain.place(foot)[2]) for foot in ground.feet)
        level[6] = 1.0 - lowest + _FOOT + _DROP
        self._chain.reset(np.tile(_STAND, 4), base=level)
        self._torque, self._rows, self._speed = np.zeros(12), 0, np.zeros(3)

    @property
    def pose(self) -> np.ndarray:
        """Return the true pose of the trunk (7,): quaternion w x y z, position [m]."""
        return self._chain.base

    @property
    def motion(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the true motion of the trunk in its own frame, (3,) each.

        Direction of gravity, linear [m/s] and angular velocity [rad/s].
        """
        quaternion: Any = self._chain.base[:4] / np.linalg.norm(self._chain.base[:4])
        turn = RotationMatrix(Quaternion(quaternion)).matrix().T
        rate = self._chain.base_velocity
        return turn @ np.array([0.0, 0.0, -1.0]), turn @ rate[3:], turn @ rate[:3]

    def look(self) -> list[Look]:
        """Return the present readings of encoders and current sensors."""
        s, q = self._sensors, self._chain.position
        if s.encoder:
            q = s.encoder * np.round(q / s.encoder)
        noise = self._generator.standard_normal((2, 12))
        w, t = self._chain.velocity + s.velocity_noise * noise[0], self._torque + s.torque_noise * noise[1]
        return list(zip(q.tolist(), w.tolist(), t.tolist(), strict=True))

    def feel(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the present readings of the inertial unit (3,): angular velocity [rad/s], gravity
        direction, force per weight.

        The force is the mean since it was last asked, as of a unit that filters for its own rate.
        """
        gravity, _, angular = self.motion
        noise = self._generator.standard_normal((2, 3))
        return angular + GYRO_NOISE * noise[0], gravity + GRAVITY_NOISE * noise[1], self._carried(gravity)

    def push(self, roll: float, lift: float = 0.0) -> None:
        """Hit the robot: change the roll rate [rad/s] and the upward speed [m/s] of the trunk at once."""
        self._chain.kick(np.array([roll, 0.0, 0.0, 0.0, 0.0, lift]))

    def lay(self, roll: float, height: float) -> None:
        """Place the robot: trunk rolled [rad], at a height above the ground [m], at rest."""
        half = 0.5 * roll
        pose = np.array([np.cos(half), np.sin(half), 0.0, 0.0, 0.0, 0.0, height])
        self._chain.reset(self._chain.position, base=pose)

    def _carried(self, gravity: np.ndarray) -> np.ndarray:
        """Force on the trunk per its weight, in its frame (3,), and its noise."""
        quaternion: Any = self._chain.base[:4] / np.linalg.norm(self._chain.base[:4])
        speed, rows = self._chain.base_velocity[3:], max(1, self._rows)
        faster = (speed - self._speed) / (rows * self._row)
        self._speed, self._rows = speed, 0
        turned = RotationMatrix(Quaternion(quaternion)).matrix().T @ faster
        return turned / _G - gravity + FORCE_NOISE * self._generator.standard_normal(3)

    def command(self, torque: Sequence[float]) -> None:
        """Set the torques of the row that begins [N m]."""
        self._torque = np.clip(np.array(torque), -TORQUE_LIMIT, TORQUE_LIMIT)

    def advance(self) -> None:
        """Simulate one row.

        Raises:
            SimulationError: the robot ran away.
        """
        if self.held:
            return
        self._chain.advance(self._torque)
        self._rows += 1
        if not np.abs(self._chain.velocity).max() < 1e3:
            raise SimulationError("the quadruped ran away")
