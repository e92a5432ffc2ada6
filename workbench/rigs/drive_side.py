"""A drive alone: on a bench without a leg, or behind a joint of a robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from workbench.core import InputError

from .hidden import HiddenEffect
from .machine import ACTUATOR_DAMPING, ACTUATOR_INERTIA

#: Effects that a drive has by itself, and those that it has only with something hanging on it.
_OWN = ("torque_constant_error", "coulomb_friction", "viscous_damping", "reflected_inertia")
_COUPLED = ("backlash",)
_OF_LINKS = ("linkage_inertia", "linkage_gravity", "payload_mass", "link_length_error", "base_compliance")


@dataclass(frozen=True)
class DriveSide:
    """One drive at its output.

    Attributes:
        inertia: of the rotor [kg m^2].
        damping: [N m s/rad].
        gain: true torque over torque by the nominal constant.
        friction: dry friction, the same at any speed [N m].
        gap: whole play between drive and link [rad]; 0 for a rigid one.
        stiffness: of the flanks of that gap [N m/rad].
    """

    inertia: float = ACTUATOR_INERTIA
    damping: float = ACTUATOR_DAMPING
    gain: float = 1.0
    friction: float = 0.0
    gap: float = 0.0
    stiffness: float = 0.0

    @property
    def rigid(self) -> bool:
        """Return whether rotor and link are rigidly connected."""
        return self.stiffness == 0.0


def drive_side(hidden: Sequence[HiddenEffect], axis: str) -> DriveSide:
    """Return the drive of one axis of a leg with these hidden effects.

    What sits in the links is not the drive's and is passed over.

    Args:
        hidden: of the whole leg.
        axis: ``hip`` or ``knee``.

    Raises:
        InputError: an effect of this drive that a drive by itself cannot have here.
    """
    side = DriveSide()
    for effect in hidden:
        if effect.effect in _OF_LINKS or effect.axis != axis or effect.location != "actuator":
            continue
        if effect.effect not in (*_OWN, *_COUPLED):
            raise InputError(
                f"a drive by itself cannot hide '{effect.effect}'",
                remedy=f"hide {', '.join((*_OWN, *_COUPLED))}, or what sits in the links",
            )
        side = _with(side, effect)
    return side


def _with(side: DriveSide, effect: HiddenEffect) -> DriveSide:
    p = effect.parameters
    match effect.effect:
        case "torque_constant_error":
            return replace(side, gain=side.gain * p["gain"])
        case "coulomb_friction":
            return replace(side, friction=side.friction + p["torque"])
        case "viscous_damping":
            return replace(side, damping=side.damping + p["damping"])
        case "reflected_inertia":
            return replace(side, inertia=side.inertia + p["inertia"])
        case _ if p.get("damping"):
            raise InputError("flanks of a drive by itself are elastic", remedy="hide a gap without damping")
        case _:
            return replace(side, gap=p["gap"], stiffness=p["stiffness"])
