"""The legs of a machine, for the prediction of the swing leg."""

from __future__ import annotations

from workbench.gait import Limbs, limbs_of

from .machine import LEGS, Machine


def machine_limbs(machine: Machine) -> Limbs:
    """Return the legs of a quadruped; drives with play start in the middle of it."""
    rotors = machine.rotors
    apart = (rotors.places, rotors.dofs, rotors.follow, rotors.drives) if len(rotors.places) else None
    feet = [f"{leg}_sphere" for leg in LEGS]
    return limbs_of(machine.mujoco, machine.joints, machine.transmission, feet, apart)
