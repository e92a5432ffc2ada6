"""Joints of a complete robot: axes that a transmission couples, and axes that are joints themselves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.can import CanConfig
from workbench.can.tables import MechanismTable
from workbench.core import DriveMap, InputError

_HUGE, _FAR = 10.0, 100.0  # times the range; without limits [rad]


@dataclass(frozen=True, eq=False)
class Joints:
    """q_p = J q_s, tau_p = J^-T tau_s (paper, Eq. 1), or q_p = f(q_s) and J its slope.

    Attributes:
        names: of the joints (n,).
        matrix: J (n, n); the identity for mechanisms in `maps`.
        low, high: limits of the joints (n,) [rad]; infinite where none is stated.
        maps: mechanisms whose transmission changes with the posture: which axes, and how they follow the
            joints.
    """

    names: tuple[str, ...]
    matrix: np.ndarray
    low: np.ndarray
    high: np.ndarray
    maps: tuple[tuple[list[int], DriveMap], ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "inverse", np.linalg.inv(self.matrix))

    inverse: np.ndarray = None  # pyright: ignore[reportAssignmentType]  (made of matrix)

    def motion(self, axes: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return joint positions and speeds (..., n) for those of the axes (..., n)."""
        q, w = axes @ self.inverse.T, speeds @ self.inverse.T
        for at, own in self.maps:
            if np.isfinite(axes[..., at]).all() and np.isfinite(speeds[..., at]).all():
                q[..., at] = own.joints(axes[..., at])
                w[..., at] = own.joint_speed(q[..., at], speeds[..., at])
            else:
                q[..., at] = w[..., at] = np.nan
        return q, w

    def position(self, axes: np.ndarray) -> np.ndarray:
        """Return joint positions (..., n) for those of the axes (..., n)."""
        return self.motion(axes, np.zeros_like(axes))[0]

    def axes(self, joints: np.ndarray) -> np.ndarray:
        """Return axis positions (..., n) for joint positions (..., n)."""
        out = joints @ self.matrix.T
        for at, own in self.maps:
            out[..., at] = own.drives(joints[..., at])
        return out

    def torque(self, joints: np.ndarray, position: np.ndarray) -> np.ndarray:
        """Return axis torques (..., n) of joint torques (..., n) at joint positions, J^-T tau_s [N m]."""
        out = joints @ self.inverse
        for at, own in self.maps:
            out[..., at] = own.drive_torque(position[..., at], joints[..., at])
        return out

    def sane(self, reference: np.ndarray) -> bool:
        """Return whether a reference (n,) is one that a working controller could command."""
        limited = np.isfinite(self.low) & np.isfinite(self.high)
        low, high = np.where(limited, self.low, -_FAR / _HUGE), np.where(limited, self.high, _FAR / _HUGE)
        away = np.abs(reference - 0.5 * (low + high))
        return bool((away <= _HUGE * 0.5 * (high - low)).all())

    def within(self, reference: np.ndarray) -> np.ndarray:
        """Return a reference (n,) clipped to the limits of the joints."""
        return np.clip(reference, self.low, self.high)


def joints_of(config: CanConfig) -> Joints:
    """Return the joints of a configuration; an axis without a mechanism is its own joint.

    Raises:
        InputError: a model cannot be read, has another number of axes, or a transmission that changes with
            the posture.
    """
    n = len(config.motor)
    matrix, names = np.eye(n), list(config.axes)
    low, high = np.full(n, -np.inf), np.full(n, np.inf)
    maps: list[tuple[list[int], DriveMap]] = []
    for mechanism in config.mechanism:
        at = [config.axes.index(axis) for axis in mechanism.axes]
        stated, limits = mechanism.transmission, mechanism.limits
        if not stated:
            stated, chain, own = _of_model(mechanism, config)
            limits = limits or chain
            maps += [] if own is None else [(at, own)]
        matrix[np.ix_(at, at)] = np.array(stated)
        for k, index in enumerate(at):
            names[index] = mechanism.joints[k] if mechanism.joints else names[index]
            if limits:
                low[index], high[index] = limits[k]
    return Joints(tuple(names), matrix, low, high, tuple(maps))


def _of_model(
    mechanism: MechanismTable, config: CanConfig
) -> tuple[np.ndarray, Sequence[tuple[float, float]], DriveMap | None]:
    """Transmission and joints' limits of a mechanism, by its model."""
    where = {"file": config.source, "column": "mechanism.model"}
    try:
        from workbench.models import read_model
        from workbench.s3n import drive_map
    except ImportError as error:
        remedy = "write the mechanism's transmission and limits here, as rows of numbers"
        problem = f"models need the whole workbench: {error.name} is missing"
        raise InputError(problem, **where, remedy=remedy) from error
    model = read_model(mechanism.model)
    if model.size != len(mechanism.axes):
        raise InputError(
            f"'{mechanism.model}' has {model.size} axes, here are {len(mechanism.axes)}",
            **where, remedy="name its axes in the model's order",
        )  # fmt: skip
    limits = model.closed_chain.limits if model.closed_chain else ()
    if not model.posture_dependent:
        return model.transmission, limits, None
    return np.eye(model.size), limits, drive_map(model)
