"""Links of any mechanism in drive coordinates, from the closed chain in Drake."""

from __future__ import annotations

import numpy as np

from workbench.core import SimulationError
from workbench.mechanism import ClosedChain

from .own_machine import OwnMachine


class OwnLinks:
    """Mass, forces and serial joints at drive positions.

    Args:
        machine: its mechanism, payload and rotors on joints.

    Raises:
        InputError: the mechanism cannot be read, or its loops do not close.
    """

    def __init__(self, machine: OwnMachine) -> None:
        self._chain = ClosedChain(machine.mechanism, machine.payload)
        self._map = machine.transmission
        self._back = None if self._map is None else np.linalg.inv(self._map)
        self._rotors = np.diag(machine.joint_inertia)
        self.units = self._chain.units

    def start(self, joints: np.ndarray | None) -> np.ndarray:
        """Return drive positions (n,) at serial positions `joints` (n,), or where it was assembled.

        Raises:
            SimulationError: the loops cannot be closed there.
        """
        if self._map is not None:
            return self._map @ (self._chain.start[1] if joints is None else joints)
        return self._chain.start[0] if joints is None else self._chain.drive_position(joints)

    def joints(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return serial positions (n,) and d q_s / d q_p (n, n) at drive positions `q` (n,)."""
        if self._back is not None:
            return self._back @ q, self._back
        return self._chain.serial_slope(q)

    def at(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return mass (n, n) and the torque of gravity and velocity terms (n,) at `q`, `v` (n,).

        Raises:
            SimulationError: the loops cannot be closed, or are at a dead point.
        """
        if self._back is None:
            found = self._chain.reduced_dynamics(q, v)
            mass, force = found.mass, found.gravity - found.bias
            if self._rotors.any():
                slope = self._chain.serial_slope(q)[1]
                mass = mass + slope.T @ self._rotors @ slope
            return mass, force
        back = self._back
        found = self._chain.reduced_dynamics(back @ q, back @ v)
        return back.T @ (found.mass + self._rotors) @ back, back.T @ (found.gravity - found.bias)


def reachable(links: OwnLinks, joints: np.ndarray, name: str) -> np.ndarray:
    """Return drive positions at the first row of a reference.

    Raises:
        SimulationError: the mechanism cannot be there; says of which machine.
    """
    try:
        return links.start(joints)
    except SimulationError as error:
        raise SimulationError(f"{name} cannot begin at its reference: {error}") from error
