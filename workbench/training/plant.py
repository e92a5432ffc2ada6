"""What a plant of an evaluation is: it moves under the torques of its drives and tells its state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from .machine import Machine
from .situation import base_state

_FALL = 0.005  # m that the quadruped is let down from


@dataclass(frozen=True)
class State:
    """State at one time: true motion of the drives (n,), of the base in MuJoCo's order, and the loads of the
    feet.

    `pose` (7,): position, quaternion w x y z. `rate` (6,): linear velocity in the world, angular velocity in
    the body. `feet` (F, 3): force of the ground on each foot, the mean over the control step before [N], as
    a force plate of that bandwidth shows it. All empty for a leg on its stand.
    """

    position: np.ndarray
    velocity: np.ndarray
    pose: np.ndarray
    rate: np.ndarray
    feet: np.ndarray


class Plant(Protocol):
    """A plant that moves under drive torques held over a control step."""

    def reset(self, drives: np.ndarray, height: float) -> None:
        """Set it at rest at drive positions (n,), with the base level at a height [m]."""
        ...

    def advance(self, torque: np.ndarray) -> None:
        """Simulate one control step under drive torques (n,) [N m]."""
        ...

    def push(self, force: np.ndarray) -> None:
        """Push the base at its origin with a force in the world (3,) [N], from now on; zero ends it."""
        ...

    def state(self) -> State:
        """Return the present state."""
        ...


def begin(plant: Plant, machine: Machine) -> None:
    """Set a plant at rest in the posture of the machine, a little above the ground."""
    plant.reset(machine.drive_position(machine.posture), machine.height + _FALL)


def body_frame(state: State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return direction of gravity, linear and angular velocity in the frame of the base, (1, 3) each."""
    return base_state(np, state.pose[None], state.rate[None])
