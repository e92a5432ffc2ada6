"""Hidden effects that let motor, link and stand move apart, that move the pins, or that are in the ground."""

from __future__ import annotations

from dataclasses import replace

from workbench.core import InputError

from .coupling import Base, Coupling
from .machine import Machine, once
from .place import Place
from .standing_leg import Plate


def joint_compliance(machine: Machine, at: Place, *, stiffness: float, damping: float) -> None:
    """A spring and a damper between motor and link; in the knee joint, between linkage and shank."""
    _couple(machine, at, Coupling(stiffness, damping))


def backlash(machine: Machine, at: Place, *, gap: float, stiffness: float, damping: float = 0.0) -> None:
    """A dead zone of width `gap` between motor and link; both flanks have this stiffness and damping."""
    _couple(machine, at, Coupling(stiffness, damping, gap))


def _couple(machine: Machine, at: Place, coupling: Coupling) -> None:
    seat = at if at.index else replace(at, at_pin=False)  # nothing lies between the hip's drive and its pin
    once(machine.couplings.get(seat), "spring or gap between a motor and its link")
    machine.couplings[seat] = coupling


def base_compliance(machine: Machine, at: Place, *, stiffness: float, damping: float, mass: float) -> None:
    """The stand, of this mass without the leg, slides along x on a spring and a damper."""
    once(machine.base, "compliant stand")
    machine.base = Base(stiffness, damping, mass)


def link_length_error(machine: Machine, at: Place, *, length: float) -> None:
    """The thigh (hip) or the shank (knee) is longer by `length`; `leg_file` says what moves with it."""
    machine.longer[at.index] += length


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
