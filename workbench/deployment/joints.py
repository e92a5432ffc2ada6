"""Joints of a whole robot: axes that a transmission couples, and axes that are joints themselves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.can import CanConfig
from workbench.can.tables import MechanismTable
from workbench.core import InputError

_HUGE, _FAR = 10.0, 100.0  # times the range; without limits [rad]


@dataclass(frozen=True, eq=False)
class Joints:
    """q_p = J q_s, tau_p = J^-T tau_s (paper, Eq. 1).

    Attributes:
        names: of the joints (n,).
        matrix: J (n, n).
        low, high: limits of the joints (n,) [rad]; infinite where none is stated.
    """

    names: tuple[str, ...]
    matrix: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def __post_init__(self) -> None:
        object.__setattr__(self, "inverse", np.linalg.inv(self.matrix))

    inverse: np.ndarray = None  # pyright: ignore[reportAssignmentType]  (made of matrix)

    def position(self, axes: np.ndarray) -> np.ndarray:
        """Joint positions or speeds (n,) of those of the axes (n,)."""
        return self.inverse @ axes

    def torque(self, joints: np.ndarray) -> np.ndarray:
        """Axis torques (n,) of joint torques (n,), J^-T tau_s [N m]."""
        return self.inverse.T @ joints

    def sane(self, reference: np.ndarray) -> bool:
        """Whether a reference (n,) is one that a controller that works could ask for."""
        limited = np.isfinite(self.low) & np.isfinite(self.high)
        low, high = np.where(limited, self.low, -_FAR / _HUGE), np.where(limited, self.high, _FAR / _HUGE)
        away = np.abs(reference - 0.5 * (low + high))
        return bool((away <= _HUGE * 0.5 * (high - low)).all())

    def within(self, reference: np.ndarray) -> np.ndarray:
        """A reference (n,) within the joints' limits."""
        return np.clip(reference, self.low, self.high)


def joints_of(config: CanConfig) -> Joints:
    """The joints of a configuration; an axis in no mechanism is its own joint.

    Raises:
        InputError: a model cannot be read, has another number of axes, or a transmission that changes with
            the posture.
    """
    n = len(config.motor)
    matrix, names = np.eye(n), list(config.axes)
    low, high = np.full(n, -np.inf), np.full(n, np.inf)
    for mechanism in config.mechanism:
        at = [config.axes.index(axis) for axis in mechanism.axes]
        stated, limits = mechanism.transmission, mechanism.limits
        if not stated:
            stated, chain = _of_model(mechanism, config)
            limits = limits or chain
        matrix[np.ix_(at, at)] = np.array(stated)
        for k, index in enumerate(at):
            names[index] = mechanism.joints[k] if mechanism.joints else names[index]
            if limits:
                low[index], high[index] = limits[k]
    return Joints(tuple(names), matrix, low, high)


def _of_model(
    mechanism: MechanismTable, config: CanConfig
) -> tuple[np.ndarray, Sequence[tuple[float, float]]]:
    """Transmission and joints' limits of a mechanism, by its model."""
    where = {"file": config.source, "column": "mechanism.model"}
    try:
        from workbench.models import read_model
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
    if model.posture_dependent:
        remedy = "only constant transmissions are run over CAN so far"
        raise InputError(f"the transmission of '{mechanism.model}' changes", **where, remedy=remedy)
    return model.transmission, model.closed_chain.limits if model.closed_chain else ()
