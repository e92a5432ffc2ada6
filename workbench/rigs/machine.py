"""The true leg of the rig: all that acts between a commanded torque and the motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .friction import Friction
from .integrate import PassiveTorque
from .structure import LegStructure, leg_structure

AXES = ("hip", "knee")
ACTUATOR_INERTIA = 0.0162  # N^2 J_m of both drives [kg m^2]
ACTUATOR_DAMPING = 0.0972  # N^2 B_m of both drives [N m s/rad]
DRIVE_DELAY = 3e-3  # T_d, from command to torque [s]
TORQUE_LIMIT = 24.0  # clipped in the drive [N m]

Direction = tuple[float, float]


@dataclass(frozen=True)
class Place:
    """Where an effect acts.

    Attributes:
        index: of the motor.
        direction: d; position there is d . q, and a torque there enters as d times it, in actuator
            coordinates.
    """

    index: int
    direction: Direction


#: Torque on one axis over the rows of a run: row times (N,) [s], generator -> (N,) [N m].
Disturbance = Callable[[np.ndarray, np.random.Generator], np.ndarray]


@dataclass
class Machine:
    """What hidden effects change; each list holds one value a motor, in the order of `AXES`.

    The torque chain reads, in this order: `delay`, `limit`, `lag`, (torque sensor), `gain`, `bias`,
    `disturbances`, `frictions` and `passive`, `structure`.

    Attributes:
        structure: inertia and gravity, rotors included.
        delay: from command to torque [s].
        limit: largest torque of each drive [N m].
        lag: time constant of each current loop [s], 0 for none.
        gain: true torque over torque by the nominal constant.
        bias: torque added after the sensor [N m].
        disturbances: unmeasured torques as (axis index, function).
        frictions: dry frictions.
        damping: viscous damping of each drive [N m s/rad].
        passive: smooth torques of the state.
    """

    structure: LegStructure = field(
        default_factory=lambda: leg_structure().plus(m11=ACTUATOR_INERTIA, m22=ACTUATOR_INERTIA)
    )
    delay: float = DRIVE_DELAY
    limit: list[float] = field(default_factory=lambda: [TORQUE_LIMIT, TORQUE_LIMIT])
    lag: list[float] = field(default_factory=lambda: [0.0, 0.0])
    gain: list[float] = field(default_factory=lambda: [1.0, 1.0])
    bias: list[float] = field(default_factory=lambda: [0.0, 0.0])
    disturbances: list[tuple[int, Disturbance]] = field(default_factory=list)
    frictions: list[Friction] = field(default_factory=list)
    damping: list[float] = field(default_factory=lambda: [ACTUATOR_DAMPING, ACTUATOR_DAMPING])
    passive: list[PassiveTorque] = field(default_factory=list)
