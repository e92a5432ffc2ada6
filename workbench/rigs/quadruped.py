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
GYRO_NOISE, GRAVITY_NOISE = 0.02, 0.005  # rad/s and share of g: noise of a common inertial unit


def quadruped_mechanism() -> Mechanism:
    """The reference quadruped with abduction: 12 drives, four loops."""
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
        self.held, self._sensors = True, sensors or Sensors()
        self._generator = np.random.default_rng([seed, 43])
        ground = Ground(tuple(f"{leg}_foot" for leg in LEGS), _FOOT, _FRICTION)
        inertia, damping = [ACTUATOR_INERTIA] * 12, [ACTUATOR_DAMPING] * 12
        self._chain = DiscreteChain(quadruped_mechanism(), inertia, damping, row, ground)
        level = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
        self._chain.reset(np.tile(_STAND, 4), base=level)
        lowest = min(float(self._chain.place(foot)[2]) for foot in ground.feet)
        level[6] = 1.0 - lowest + _FOOT + _DROP
        self._chain.reset(np.tile(_STAND, 4), base=level)
        self._torque = np.zeros(12)

    @property
    def pose(self) -> np.ndarray:
        """Of the trunk (7,), as it truly is: quaternion w x y z, position [m]."""
        return self._chain.base

    @property
    def motion(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the trunk, in its own frame, as it truly is, (3,) each.

        Direction of gravity, linear [m/s] and angular velocity [rad/s].
        """
        quaternion: Any = self._chain.base[:4] / np.linalg.norm(self._chain.base[:4])
        turn = RotationMatrix(Quaternion(quaternion)).matrix().T
        rate = self._chain.base_velocity
        return turn @ np.array([0.0, 0.0, -1.0]), turn @ rate[3:], turn @ rate[:3]

    def look(self) -> list[Look]:
        """What encoders and current sensors show now."""
        s, q = self._sensors, self._chain.position
        if s.encoder:
            q = s.encoder * np.round(q / s.encoder)
        noise = self._generator.standard_normal((2, 12))
        w, t = self._chain.velocity + s.velocity_noise * noise[0], self._torque + s.torque_noise * noise[1]
        return list(zip(q.tolist(), w.tolist(), t.tolist(), strict=True))

    def feel(self) -> tuple[np.ndarray, np.ndarray]:
        """What the inertial unit shows now (3,): angular velocity [rad/s], direction of gravity."""
        gravity, _, angular = self.motion
        noise = self._generator.standard_normal((2, 3))
        return angular + GYRO_NOISE * noise[0], gravity + GRAVITY_NOISE * noise[1]

    def command(self, torque: Sequence[float]) -> None:
        """The torques of the row that begins [N m]."""
        self._torque = np.clip(np.array(torque), -TORQUE_LIMIT, TORQUE_LIMIT)

    def advance(self) -> None:
        """One row.

        Raises:
            SimulationError: the robot ran away.
        """
        if self.held:
            return
        self._chain.advance(self._torque)
        if not np.abs(self._chain.velocity).max() < 1e3:
            raise SimulationError("the quadruped ran away")
