"""Virtual hardware of any mechanism: its links, drives and sensors, and hidden effects.

Fields that hidden effects change have the names of `machine.Machine`, so that what an effect does is written
once for the reference leg and for any other machine.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from workbench.core import Controller, InputError, Mechanism

from .coupling import Coupling
from .friction import Friction
from .hidden import AT_JOINTS, EFFECTS, OUTSIDERS, WITHOUT_AXIS
from .machine import Derating, Disturbance, Encoder, Reshaped, SpeedLimit
from .place import Passive, Place
from .unfit import unfit

#: Hidden effects that speak of the reference leg's own shape, or of what no mechanism's file says.
OF_THE_LEG = frozenset(
    {
        "linkage_inertia", "linkage_gravity", "link_length_error", "base_compliance", "cross_spring",
        "cross_damping", "presliding_hysteresis",
    }
)  # fmt: skip
_ALL = {name: install for name, install in {**EFFECTS, **OUTSIDERS}.items() if name not in OF_THE_LEG}
#: Effects that this hardware can hide.
HIDEABLE = tuple(sorted(_ALL))
_BETWEEN_DRIVE_AND_LINK = ("backlash", "joint_compliance")


@dataclass
class OwnMachine:
    """A mechanism with n drives; lists hold one value per drive, in the order of `axes`.

    Attributes:
        name: of the machine, for messages and recordings.
        axes: names of the drives in recordings.
        mechanism: its links and loops.
        transmission: (n, n) of a mechanism that is a tree of its serial joints, the drives at
            ``transmission @ joints``; None where drives are joints of the mechanism itself.
        rotor, damping: of each drive at its output [kg m^2, N m s/rad].
        limit: largest torque [N m].
        delay: from command to torque [s].
        controller: the loop, stated truly.
        joint_inertia: of rotors that sit on serial joints (n,) [kg m^2].
        others: as in `machine.Machine`; a `Place` at a pin counts serial joints, any other one drives.
    """

    name: str
    axes: tuple[str, ...]
    mechanism: Mechanism
    transmission: np.ndarray | None
    rotor: list[float]
    damping: list[float]
    limit: list[float]
    delay: float
    controller: Controller
    joint_inertia: list[float] = field(default_factory=list)
    speed_limit: list[SpeedLimit | None] = field(default_factory=list)
    lag: list[float] = field(default_factory=list)
    reshaped: list[tuple[int, Reshaped]] = field(default_factory=list)
    gain: list[float] = field(default_factory=list)
    derating: list[Derating | None] = field(default_factory=list)
    bias: list[float] = field(default_factory=list)
    disturbances: list[tuple[int, Disturbance]] = field(default_factory=list)
    frictions: list[Friction] = field(default_factory=list)
    passive: list[Passive] = field(default_factory=list)
    couplings: dict[Place, Coupling] = field(default_factory=dict)
    payload: float = 0.0
    encoders: list[Encoder] = field(default_factory=list)
    sensor_delay: float = 0.0
    velocity_lag: list[float] = field(default_factory=list)
    kp_scale: list[float] = field(default_factory=list)
    kd_scale: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        n = self.size
        for key in ("lag", "bias", "velocity_lag", "joint_inertia"):
            setattr(self, key, getattr(self, key) or [0.0] * n)
        for key in ("gain", "kp_scale", "kd_scale"):
            setattr(self, key, [1.0] * n)
        self.speed_limit, self.derating = [None] * n, [None] * n
        self.encoders = [Encoder() for _ in range(n)]

    @property
    def size(self) -> int:
        """Return the number of drives n."""
        return len(self.axes)

    def place(self, axis: str | None, location: str) -> Place:
        """Return where an effect of this axis acts; the first drive if it has no axis.

        Raises:
            InputError: the machine has no such axis or place.
        """
        if axis is not None and axis not in self.axes:
            raise InputError(f"{self.name} has no axis '{axis}'", remedy=f"axes are {', '.join(self.axes)}")
        if location not in ("actuator", "joint"):
            raise InputError(f"no such place: {location}", remedy="actuator or joint")
        index = 0 if axis is None else self.axes.index(axis)
        one = tuple(float(k == index) for k in range(self.size))
        return Place(index, one, location == "joint")  # pyright: ignore[reportArgumentType]  (n, not two)


@dataclass(frozen=True)
class HiddenIn:
    """An effect of the user's own machine that its model does not contain; as `hidden.HiddenEffect`."""

    effect: str
    axis: str | None = None
    location: str = "actuator"
    parameters: Mapping[str, float] = field(default_factory=dict)


def hide(effect: HiddenIn, machine: OwnMachine) -> None:
    """Add `effect` to `machine`.

    Raises:
        InputError: this hardware cannot hide it, or has no such place, or its parameters do not fit.
    """
    name = effect.effect
    if name not in _ALL:
        known = {**EFFECTS, **OUTSIDERS}
        why = "is one of the reference leg alone" if name in known else "is not an effect that can be hidden"
        raise InputError(
            f"'{name}' {why}: the virtual hardware of {machine.name} cannot hide it",
            remedy=f"one of {', '.join(HIDEABLE)}",
        )
    if effect.axis is None and name not in WITHOUT_AXIS:
        raise InputError(
            f"'{name}' acts on one axis", remedy=f"name it, e.g. --hide {name}@{machine.axes[0]}"
        )
    where = machine.place(effect.axis, effect.location)
    if where.at_pin and (name not in AT_JOINTS or name in _BETWEEN_DRIVE_AND_LINK):
        raise InputError(f"'{name}' cannot sit in a joint of {machine.name}", remedy="hide it in the drive")
    if name == "payload_mass" and not machine.mechanism.foot:
        raise InputError(f"{machine.name} has no foot to carry a payload", remedy="name its foot")
    given: dict[str, Any] = dict(effect.parameters)
    if wrong := unfit(name, _ALL[name], given):
        raise wrong
    _ALL[name](machine, where, **given)  # pyright: ignore[reportArgumentType]  (fields of the same names)
