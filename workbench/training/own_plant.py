"""The mechanism of any model of one limb, with or without loops, as virtual hardware for a policy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import InputError
from workbench.importing import own_rig
from workbench.rigs import HiddenEffect, HiddenIn
from workbench.rigs.own_drives import OwnDrives
from workbench.rigs.own_motion import OwnMotion

from .machine import STEP_S, Machine
from .plant import State

_PIECES = 12  # of a control step: 0.25 ms


class OwnPlant:
    """The closed chain of the model in Drake, its drives, its friction, and hidden effects.

    Args:
        machine: of kind ``leg``; its delay is the loop's, which holds every torque back.
        hidden: effects beyond those of the model.

    Raises:
        InputError: hardware that cannot be made of this model, or an effect that it cannot hide.
    """

    def __init__(self, machine: Machine, hidden: Sequence[HiddenEffect] = ()) -> None:
        more = [HiddenIn(h.effect, h.axis, h.location, h.parameters) for h in hidden]
        rig = own_rig(machine.model, more)
        rig.machine.delay = max(0.0, rig.machine.delay - machine.delay_steps * STEP_S)
        piece = STEP_S / _PIECES
        self._drives = OwnDrives(rig.machine, piece, np.random.default_rng(0))
        self._motion = OwnMotion(rig.machine, rig.links, piece)
        self._state = self._motion.start(rig.links.start(None))
        self._nothing = np.zeros(rig.machine.size)

    def reset(self, drives: np.ndarray, height: float) -> None:
        """Set the plant at rest at drive positions (n,)."""
        self._state = self._motion.start(np.array(drives, float))

    def advance(self, torque: np.ndarray) -> None:
        """Simulate one control step.

        Raises:
            SimulationError: the mechanism leaves its workspace.
        """
        for _ in range(_PIECES):
            self._drives.command(torque)
            acting = self._drives.acting(self._state.speed, self._nothing)
            self._state = self._motion.advance(self._state, acting)

    def push(self, force: np.ndarray) -> None:
        """Raise: a limb on its stand has no base that could be pushed.

        Raises:
            InputError: always.
        """
        raise InputError("this limb is fixed to its stand", remedy="push a robot that walks")

    def state(self) -> State:
        """Return the present state."""
        none = np.zeros(0)
        return State(self._state.motor.copy(), self._state.speed.copy(), none, none, np.zeros((0, 3)))
