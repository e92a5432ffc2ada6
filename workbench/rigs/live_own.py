"""Any machine, driven from outside row by row, as `live.LiveLeg` for the reference leg."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import SimulationError

from .live import ROW, Look
from .machine import rows_ahead, unmeasured
from .own_drives import OwnDrives
from .own_motion import OwnMotion, refuse_runaway
from .own_rig import OwnRig, Sensing


class LiveOwn:
    """Virtual hardware behind a bus; see `live.Plant`.

    The delay of the model is that of the loop around it, which a loop over a bus makes itself: it is left
    out. What is hidden of a delay stays.

    Args:
        rig: the machine with what it hides, not used for anything else.
        delay: of the model [s].
        row: [s].

    Attributes:
        held: whether a stand holds it where it is. Without one it would fall out of its workspace: it has no
            end stops.

    Raises:
        SimulationError: the loop's gains are hidden, which is not here.
    """

    def __init__(self, rig: OwnRig, delay: float, row: float = ROW) -> None:
        machine = rig.machine
        if {*machine.kp_scale, *machine.kd_scale} != {1.0}:
            raise SimulationError("wrong gains belong to the loop: set them in its configuration")
        machine.delay = max(0.0, machine.delay - delay)
        self.axes, self._rig, self._row = machine.size, rig, row
        self._generator = np.random.default_rng([rig.seed, 43])
        self._drives = OwnDrives(machine, row, self._generator)
        self._motion = OwnMotion(machine, rig.links, row)
        self._state = self._motion.start(rig.links.start(None))
        self._sensing = Sensing(machine, row, self._state.motor)
        self._unmeasured, self._count = self._disturbed(), 0
        self._commanded = self.held = False

    def look(self) -> list[Look]:
        """Return the present readings of encoders and current sensors."""
        s, n = self._rig.sensors, self._generator.standard_normal((2, self.axes))
        q, w = self._sensing.look()
        q = np.round(q / s.encoder) * s.encoder if s.encoder else q
        w = w + s.velocity_noise * n[0]
        torque = self._drives.measured(self._state.speed) + s.torque_noise * n[1]
        return [(float(a), float(b), float(c)) for a, b, c in zip(q, w, torque, strict=True)]

    def command(self, torque: Sequence[float]) -> None:
        """Set the torques of the row that begins, so that readings show them."""
        self._drives.command(np.array(torque, float), again=self._commanded)
        self._commanded = True

    def advance(self) -> None:
        """Simulate one row.

        Raises:
            SimulationError: the machine ran away, or left its workspace.
        """
        pushed = self._unmeasured[self._count % len(self._unmeasured)]
        self._count, self._commanded = self._count + 1, False
        acting = self._drives.acting(self._state.speed, pushed)
        if self.held:
            self._state = self._motion.rest(self._state)
        else:
            self._state = self._motion.advance(self._state, acting)
        self._sensing.see(self._state.motor, self._state.speed)
        refuse_runaway(self._state, self._count * self._row, self._rig.machine.name)

    def _disturbed(self) -> np.ndarray:
        """Disturbances (N, n) of the rows to come [N m]."""
        disturbances = self._rig.machine.disturbances
        time = rows_ahead(disturbances, self._row)
        return unmeasured([0.0] * self.axes, disturbances, time, self._generator)
