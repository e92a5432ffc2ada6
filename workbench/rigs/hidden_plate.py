"""Hidden effects of the ground under the foot."""

from __future__ import annotations

from workbench.core import InputError

from .machine import Machine
from .place import Place
from .standing_leg import Plate


def contact_compliance(machine: Machine, at: Place, *, stiffness: float, damping: float) -> None:
    """A compliant plate: stiffness times depth and damping times its rate."""
    plate = _plate(machine)
    plate.stiffness, plate.damping = stiffness, damping


def ground_friction(machine: Machine, at: Place, *, coefficient: float) -> None:
    """Another friction of the plate."""
    _plate(machine).friction = coefficient


def _plate(machine: Machine) -> Plate:
    if machine.plate is None:
        raise InputError(
            "this leg stands on no ground", remedy="hide it in a leg on a plate: record leg_on_plate"
        )
    return machine.plate
