"""Recordings of a machine with a floating base: its pose becomes six additional axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from workbench.core import AXIS_SIGNALS, InputError, Recording
from workbench.models import BASE_AXES, Model

POSE = {"base_position": 3, "base_orientation": 4}
RATE = {"base_velocity": 3, "base_angular_velocity": 3}
_STILL = {"base_position": 0.005, "base_orientation": 0.01}  # m; a turn by a degree
_UNITS = ("m", "m", "m", "rad", "rad", "rad")
_STEEPEST = np.radians(80.0)  # of the pitch; near a right angle yaw and roll are one
_UNIT = 0.05  # by which the length of a quaternion may be off, as where rows were interpolated


def floats(recording: Recording) -> bool:
    """Return whether a recording contains the axes of a floating base."""
    return recording.axes[-len(BASE_AXES) :] == BASE_AXES


def with_base(recording: Recording, model: Model) -> Recording:
    """Return a recording for a model with a floating base; the coordinates of the base are axes without
    drives.

    Args:
        recording: with ``base_position`` [m] and ``base_orientation`` (w, x, y, z) of the base's frame in the
            world, and, where they were measured, ``base_velocity`` of its origin along the world's axes [m/s]
            and ``base_angular_velocity`` along its own [rad/s]; rates that were not are NaN.
        model: as it is to be run; one with a fixed base takes recordings as they are.

    Raises:
        InputError: the pose is missing, has other columns, is no rotation, or pitches beyond 80 degrees; or
            the base moved and the model's does not.
    """
    if floats(recording):
        return recording
    if not model.floats:
        for name, still in _STILL.items():
            if _range(recording, name) > still:
                raise _refusal(
                    recording, name, f"the base moves, but that of model '{model.name}' is fixed",
                    "give its MJCF a <freejoint/>, or leave these columns out",
                )  # fmt: skip
        return recording
    for name, count in (POSE | RATE).items():
        values = recording.extra.get(name)
        if values is None and name in POSE:
            raise _refusal(
                recording, name, f"the base of model '{model.name}' floats, but no column says where it was",
                "name its columns, or fix the base in the MJCF (remove the <freejoint/>)",
            )  # fmt: skip
        if values is not None and values.shape[1] != count:
            raise _refusal(
                recording, name, f"{values.shape[1]} columns instead of {count}", "see docs/recordings.md"
            )
    angles, rates = _angles(recording)
    position = recording.extra["base_position"]
    velocity = recording.extra.get("base_velocity", np.full_like(position, np.nan))
    own = {"position": np.hstack([position, angles]), "velocity": np.hstack([velocity, rates])}
    none = np.zeros((len(recording), len(BASE_AXES)))
    return replace(
        recording,
        axes=(*recording.axes, *BASE_AXES),
        units=(*recording.units, *_UNITS),
        signals={
            name: np.hstack([values, own.get(name, none)])
            for name, values in recording.signals.items()
            if name in AXIS_SIGNALS
        },
        steps={name: np.append(steps, np.zeros(len(BASE_AXES))) for name, steps in recording.steps.items()},
        extra={name: values for name, values in recording.extra.items() if name not in {**POSE, **RATE}},
    )


def _range(recording: Recording, name: str) -> float:
    """Largest range of any of a pose's numbers; a quaternion and its negative are one turn."""
    values = recording.extra.get(name)
    if values is None or not recording.valid.any():
        return 0.0
    values = values[recording.valid]
    if name == "base_orientation":
        values = values * np.where(values @ values[0] < 0.0, -1.0, 1.0)[:, None]
    return float(np.ptp(values, axis=0).max())


def _angles(recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Yaw, pitch, roll and their rates, (N, 3) each; rates NaN where none were measured."""
    quaternion = recording.extra["base_orientation"]
    length = np.linalg.norm(quaternion, axis=1)
    wrong = np.abs(length - 1.0) > _UNIT
    if (wrong & recording.valid).any():
        row = 1 + int(np.argmax(wrong & recording.valid))
        raise _refusal(
            recording, "base_orientation",
            f"its four numbers have the length {length[row - 1]:.3g} in row {row}",
            "give unit quaternions, w x y z",
        )  # fmt: skip
    safe = np.where(wrong[:, None], (1.0, 0.0, 0.0, 0.0), quaternion)
    turn = Rotation.from_quat(np.roll(safe, -1, axis=1))
    pitch = np.arcsin(np.clip(-turn.as_matrix()[:, 2, 0], -1.0, 1.0))
    steep = np.abs(pitch) > _STEEPEST
    if (steep & recording.valid).any():
        row = 1 + int(np.argmax(steep & recording.valid))
        raise _refusal(
            recording, "base_orientation",
            f"the base pitches by {np.degrees(pitch[row - 1]):.0f} degrees in row {row}",
            "give unit quaternions w x y z; the base must stay within 80 degrees of level",
        )  # fmt: skip
    turn[steep] = Rotation.identity()
    angles = np.unwrap(turn.as_euler("ZYX"), axis=0)
    turning = recording.extra.get("base_angular_velocity")
    if turning is None:
        return angles, np.full_like(angles, np.nan)
    _, pitch, roll = angles.T
    p, q, r = turning.T
    across = q * np.sin(roll) + r * np.cos(roll)
    return angles, np.stack(
        [across / np.cos(pitch), q * np.cos(roll) - r * np.sin(roll), p + np.tan(pitch) * across], axis=1
    )


def _refusal(recording: Recording, column: str, problem: str, remedy: str) -> InputError:
    return InputError(problem, file=recording.source, column=f"columns.{column}", remedy=remedy)
