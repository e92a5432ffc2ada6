"""Inputs of the terms of a task: the state of all worlds at one policy step, in numpy or torch.

`xp` is `numpy` or `torch`: everything here and in `terms`, `control` and `tasks` uses only what the two spell
alike, so that one set of lines serves the CPU and the GPU.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .machine import LEGS, POLICY_STEPS, STEP_S, Machine

Array = Any  # numpy.ndarray or torch.Tensor; shapes are in the docstrings
POLICY_S = round(POLICY_STEPS * STEP_S, 9)  # [s]


class Constants:
    """Arrays of a machine on the device and in the precision of the worlds.

    Args:
        machine: the machine.
        xp: `numpy` or `torch`.
        like: an array of the worlds, whose device and precision are taken.
    """

    def __init__(self, machine: Machine, xp: Any, like: Array) -> None:
        self.machine, self.xp, self.map = machine, xp, machine.map

        def put(values: np.ndarray) -> Array:
            if xp is np:
                return np.asarray(values)
            kind = like.dtype if values.dtype.kind == "f" else xp.int64
            return xp.as_tensor(values, dtype=kind, device=like.device)

        self.put = put
        m = machine.mujoco
        self.places, self.dofs = put(machine.places), put(machine.dofs)
        rotors = machine.rotors
        self.rotor_places, self.rotor_dofs = put(rotors.places), put(rotors.dofs)
        self.follow = put(rotors.follow.T)
        #: joints' angles as the drives' encoders have them, of joints and rotors: a row q @ read
        self.read = (
            put(np.linalg.solve(machine.transmission, rotors.drives).T) if len(rotors.places) else None
        )
        self.kp, self.kd = put(machine.kp), put(machine.kd)
        self.to_drives = put(
            np.linalg.inv(machine.transmission)
        )  # tau_p = J^-T tau_s, as a row: tau_s @ J^-1
        self.to_motion = put(machine.transmission.T)  # q_p as a row: q_s @ J^T
        self.torque_limit = put(machine.torque_limit)
        self.posture = put(machine.posture)
        self.low, self.high = put(machine.limits[:, 0]), put(machine.limits[:, 1])
        self.touch = self.speed = None
        if machine.floating:
            touch = [m.sensor(f"{leg}_touch").adr[0] for leg in LEGS]
            speed = [m.sensor(f"{leg}_speed").adr[0] for leg in LEGS]
            self.touch = put(np.array(touch))
            self.speed = put(np.array(speed)[:, None] + np.arange(3))

    def measured(self, qpos: Array, qvel: Array) -> tuple[Array, Array]:
        """Return joint angles and speeds (W, n) from the encoder readings of the drives."""
        position, velocity = qpos[:, self.places], qvel[:, self.dofs]
        if self.read is None:
            return position, velocity
        join = self.xp.concatenate
        return (
            join([position, qpos[:, self.rotor_places]], -1) @ self.read,
            join([velocity, qvel[:, self.rotor_dofs]], -1) @ self.read,
        )


@dataclass
class Situation:
    """State at one policy step; W worlds, n joints, F feet. The arrays of the base are None for a leg.

    Attributes:
        xp: the array library.
        machine: the machine's constants.
        position, velocity: of the joints (W, n) [rad, rad/s].
        torque: of the drives in the last control step (W, n) [N m].
        action, last_action: of this policy step and the one before (W, n).
        elapsed: time since the episode began (W,) [s].
        command: what the task asks for in this episode (W, c).
        height: of the base's origin (W,) [m].
        gravity: its direction in the base's frame (W, 3), unit vector.
        linear, angular: velocity of the base in its own frame (W, 3) each [m/s, rad/s].
        foot_force: normal force on each foot (W, F) [N].
        foot_speed: velocity of each foot (W, F, 3) [m/s].
        air_time: how long each foot has been off the ground (W, F) [s].
        landed: how long each foot that has just landed had been in the air (W, F) [s]; zero elsewhere.
        fallen: worlds that ended on their own (W,), bool; set before rewards are asked for.
    """

    xp: Any
    machine: Constants
    position: Array
    velocity: Array
    torque: Array
    action: Array
    last_action: Array
    elapsed: Array
    command: Array
    height: Array = None
    gravity: Array = None
    linear: Array = None
    angular: Array = None
    foot_force: Array = None
    foot_speed: Array = None
    air_time: Array = None
    landed: Array = None
    fallen: Array = None

    @property
    def pitch(self) -> Array:
        """Return the pitch of the base (W,) [rad]; nose down is positive."""
        return self.xp.arcsin(self.xp.clip(self.gravity[:, 0], -1.0, 1.0))


def base_state(xp: Any, qpos: Array, qvel: Array) -> tuple[Array, Array, Array]:
    """Return direction of gravity, linear and angular velocity in the frame of the base, (W, 3) each.

    Args:
        xp: the array library.
        qpos, qvel: MuJoCo's, with the free joint first: its linear velocity is in the world's frame, its
            angular velocity in the body's.
    """
    w, x, y, z = (qpos[:, i] for i in range(3, 7))
    rows = (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
    gravity = xp.stack([-rows[2][0], -rows[2][1], -rows[2][2]], -1)
    linear = xp.stack([sum(rows[i][k] * qvel[:, i] for i in range(3)) for k in range(3)], -1)
    return gravity, linear, qvel[:, 3:6]
