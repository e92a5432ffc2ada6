"""The leg under its motor torques, on its stand or over a force plate."""

from __future__ import annotations

from typing import Any, Protocol

from workbench.core import SimulationError

from .integrate import Integrator
from .machine import Machine
from .sensing import Motion
from .standing_leg import SHANK, THIGH, Contact, StandingLeg


class MovingLeg(Protocol):
    """Interface of an integrator, which stores its own state; use one per run."""

    def start(self, q1: float, q2: float) -> Any:
        """Return the state at rest with the motors at `q1`, `q2` [rad]."""
        ...

    def motors(self, state: Any) -> Motion:
        """Return angles [rad] and speeds [rad/s] of both motors."""
        ...

    def advance(self, state: Any, u1: float, u2: float, duration: float) -> Any:
        """Return the state after `duration` [s] under motor torques `u1`, `u2` [N m]."""
        ...


def moving_leg(machine: Machine) -> MovingLeg:
    """Return the integrator that a machine needs.

    Raises:
        SimulationError: more than two dry frictions, or a spring too stiff to follow.
    """
    if machine.plate is None:
        return Integrator(machine)
    if machine.flexible:
        raise SimulationError("the rig has no leg with springs or memory on a plate; hide something else")
    contact = Contact(machine.plate, THIGH + machine.longer[0], SHANK + machine.longer[1])
    return StandingLeg(contact, Integrator(machine, contact.torque))
