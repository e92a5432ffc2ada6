"""The true leg of the rig: everything between a reference, a commanded torque, the motion and its log."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from workbench.core import SimulationError

from .coupling import Base, Coupling
from .friction import Friction
from .place import Passive, Place
from .standing_leg import Plate
from .structure import LegStructure, leg_structure

AXES = ("hip", "knee")
ACTUATOR_INERTIA = 0.0162  # N^2 J_m of both drives [kg m^2]
ACTUATOR_DAMPING = 0.0972  # N^2 B_m of both drives [N m s/rad]
DRIVE_DELAY = 3e-3  # T_d, from command to torque [s]
TORQUE_LIMIT = 24.0  # clipped in the drive [N m]
_AHEAD = 120.0  # s

#: Torque on one axis over the rows of a run: row times (N,) [s], generator -> (N,) [N m].
Disturbance = Callable[[np.ndarray, np.random.Generator], np.ndarray]

#: Torque [N m] that a rotor gets, of the measured one and how long it acts [s], asked in time order;
#: made anew for each run, whose generator draws what is random in it.
Reshaped = Callable[[np.random.Generator], Callable[[float, float], float]]


@dataclass(frozen=True)
class SpeedLimit:
    """A limit of `stall` [N m] at rest that falls linearly to zero at `no_load` [rad/s] of driving speed.

    A drive that brakes has its voltage and its back electromotive force on the same side: it keeps `stall`.
    """

    stall: float
    no_load: float


@dataclass(frozen=True)
class Derating:
    """Torque lost to heat: gain 1 - coefficient y, with y the square of the torque through a first-order lag.

    `coefficient` [1/(N m)^2], `time_constant` [s]; every run starts cold.
    """

    coefficient: float
    time_constant: float


@dataclass
class Encoder:
    """Errors of one motor's encoder: measured = scale q + offset + the sum of e sin(q + p).

    Attributes:
        scale: [1].
        offset: [rad].
        eccentricity: pairs e, p [rad].
    """

    scale: float = 1.0
    offset: float = 0.0
    eccentricity: list[tuple[float, float]] = field(default_factory=list)


def _zeros() -> list[float]:
    return [0.0, 0.0]


def _ones() -> list[float]:
    return [1.0, 1.0]


@dataclass
class Machine:
    """Everything that hidden effects change; each list holds one value per motor, in the order of `AXES`.

    The torque chain reads, in this order: `delay`, `limit` and `speed_limit`, `lag`, (torque sensor),
    `reshaped`, `gain`, `derating`, `bias`, `disturbances`, `frictions` and `passive`, `rotor`, `couplings`,
    `links`.
    What the log shows of the motion: `encoders`, `sensor_delay`, `velocity_lag`, (noise).

    Attributes:
        delay: from command to torque [s].
        limit: largest torque of each drive [N m].
        speed_limit: a limit that falls with speed, if any.
        lag: time constant of each current loop [s], 0 for none.
        reshaped: what becomes of the torque behind its sensor as (axis index, function).
        gain: true torque over torque by the nominal constant.
        derating: how each drive loses torque to heat, if it does.
        bias: torque added after the sensor [N m].
        disturbances: unmeasured torques as (axis index, function).
        frictions: dry frictions.
        hystereses: presliding frictions as place, torque [N m], stiffness [N m/rad].
        damping: viscous damping of each drive [N m s/rad].
        passive: smooth torques of position and speed at a place.
        rotor: inertia of each drive at its output [kg m^2].
        couplings: springs and gaps in series, by place.
        increment: what the links have beyond the reference leg.
        payload: point mass at the foot [kg].
        longer: length errors of thigh and shank [m].
        base: a stand that gives way, if it does.
        plate: a force plate under the foot, if it stands on one.
        encoders: errors of position sensing.
        sensor_delay: by which position and velocity are late [s].
        velocity_lag: time constant of each velocity's filter [s], 0 for none.
        kp_scale, kd_scale: gains of the loop over those that it states, joint coordinates.
    """

    delay: float = DRIVE_DELAY
    limit: list[float] = field(default_factory=lambda: [TORQUE_LIMIT, TORQUE_LIMIT])
    speed_limit: list[SpeedLimit | None] = field(default_factory=lambda: [None, None])
    lag: list[float] = field(default_factory=_zeros)
    reshaped: list[tuple[int, Reshaped]] = field(default_factory=list)
    gain: list[float] = field(default_factory=_ones)
    derating: list[Derating | None] = field(default_factory=lambda: [None, None])
    bias: list[float] = field(default_factory=_zeros)
    disturbances: list[tuple[int, Disturbance]] = field(default_factory=list)
    frictions: list[Friction] = field(default_factory=list)
    hystereses: list[tuple[Place, float, float]] = field(default_factory=list)
    damping: list[float] = field(default_factory=lambda: [ACTUATOR_DAMPING, ACTUATOR_DAMPING])
    passive: list[Passive] = field(default_factory=list)
    rotor: list[float] = field(default_factory=lambda: [ACTUATOR_INERTIA, ACTUATOR_INERTIA])
    couplings: dict[Place, Coupling] = field(default_factory=dict)
    increment: LegStructure = field(default_factory=lambda: LegStructure(0.0, 0.0, 0.0, 0.0, 0.0))
    payload: float = 0.0
    longer: list[float] = field(default_factory=_zeros)
    base: Base | None = None
    plate: Plate | None = None
    encoders: tuple[Encoder, Encoder] = field(default_factory=lambda: (Encoder(), Encoder()))
    sensor_delay: float = 0.0
    velocity_lag: list[float] = field(default_factory=_zeros)
    kp_scale: list[float] = field(default_factory=_ones)
    kd_scale: list[float] = field(default_factory=_ones)

    @property
    def links(self) -> LegStructure:
        """Return inertia and gravity of everything behind the drives."""
        return leg_structure(self.payload, (self.longer[0], self.longer[1])).plus(**vars(self.increment))

    @property
    def flexible(self) -> bool:
        """Return whether the state needs more than two coordinates, or a memory."""
        return bool(self.couplings or self.hystereses or self.base)


def once(taken: object, what: str) -> None:
    """Refuse a second element where the rig has room for one.

    Raises:
        SimulationError: `taken` is something already.
    """
    if taken:
        raise SimulationError(f"the rig has room for one {what}; hide only one of them")


def unmeasured(
    still: Sequence[float], disturbances: Sequence[tuple[int, Disturbance]], time: np.ndarray,
    generator: np.random.Generator,
) -> np.ndarray:  # fmt: skip
    """Return torque that no sensor sees at `time` (N,) [s]: `still` (n,) and disturbances, (N, n) [N m]."""
    total = np.tile(np.array(still), (len(time), 1))
    for axis, disturbance in disturbances:
        total[:, axis] += disturbance(time, generator)
    return total


def rows_ahead(disturbances: Sequence[object], row: float) -> np.ndarray:
    """Return midpoints (N,) of rows after which a live machine's disturbances repeat [s]; one if none."""
    return (np.arange(round(_AHEAD / row) if disturbances else 1) + 0.5) * row
