"""Inputs of safety in each tick: measurements of the drives, and commands for them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True, eq=False)
class Seen:
    """Measurements at one tick; arrays (n,), axis coordinates.

    Attributes:
        now: monotonic time [s].
        position, velocity: [rad, rad/s]. temperature: [deg C], NaN where a drive tells none.
        age: of the feedback, by its receive stamp [s]; infinite before the first.
        faulty: drives that report a fault, or that they do not drive.
        bus_ok: no bus is off, no transmit queue full.
        stop: the emergency stop is pressed.
        arm: the operator asks for motion.
        verified: every drive was asked who it is, and said what it had to.
        base_age: of what is known of the base [s]; 0 where there is no base to know of.
        gravity: its direction in the base's frame (3,); NaN where there is no base to know of.
        gap: longest time between two commands since the last tick [s].
        base_same: since how long what is known of the base has not changed [s].
        carried: part of its weight that has carried the base on average; NaN where that is not known.
        torque: that drives report (n,) [N m].
        failed: what the controller failed with; None where it did not.
    """

    now: float
    position: np.ndarray
    velocity: np.ndarray
    temperature: np.ndarray
    age: np.ndarray
    faulty: np.ndarray
    bus_ok: bool = True
    stop: bool = False
    arm: bool = True
    verified: bool = True
    base_age: float = 0.0
    failed: str | None = None
    gap: float = 0.0
    base_same: float = 0.0
    carried: float = float("nan")
    torque: np.ndarray = field(default_factory=lambda: np.array(np.nan))
    gravity: np.ndarray = field(default_factory=lambda: np.full(3, np.nan))


@dataclass(frozen=True, eq=False)
class Setpoints:
    """torque + kp (position - q) + kd (velocity - w), arrays (n,), axis coordinates."""

    position: np.ndarray
    velocity: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    torque: np.ndarray


@dataclass(frozen=True, eq=False)
class Wanted:
    """Commands of a controller, and the age of the action behind them [s]."""

    setpoints: Setpoints
    age: float = 0.0
