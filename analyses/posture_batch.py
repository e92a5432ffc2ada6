"""Many worlds of a mechanism that depends on the posture, their fields written at every step."""

from __future__ import annotations

import mujoco
import numpy as np
from mujoco.batch import Batch
from posture_schedule import Schedule
from posture_worlds import ScheduledWorld, looking_ahead, settle

from workbench.s3n.worlds import State


class ScheduledBatch:
    """Many worlds stepped in one `mujoco.batch.Batch`, fields written for all of them at once.

    Args:
        schedule: what to write.
        count: number of worlds N.
        step: integration step [s].
        integrator: of MuJoCo.
        threads: of the batch; 0: all CPUs.
        hold: steps between two writes; what is held errs by the square of that time.

    Attributes:
        batch: MuJoCo's, for everything beside the mechanism; its ``qfrc_applied`` on the joints is written
            over at every write.
        inertia, damping: of the drives (N, n), to be changed world by world.
        outside: which worlds were outside the limits at the last write, (N,); if the schedule holds there.

    Raises:
        InputError: no such integrator.
    """

    def __init__(
        self,
        schedule: Schedule,
        count: int,
        step: float = 0.001,
        integrator: str = "implicitfast",
        threads: int = 0,
        hold: int = 1,
    ) -> None:
        m = schedule.spec(step, integrator).compile()
        first = ScheduledWorld(schedule, step, integrator, _inside(m, schedule), hold)
        m.dof_simplenum[:] = 0
        m.dof_armature[:], m.tendon_armature[:] = first.m.dof_armature, first.m.tendon_armature
        settle(m)
        self.schedule, self.batch = schedule, Batch(m, count, threads)
        self.hold, self.ahead = hold, first.ahead
        self._places, self._dofs, self._tendons = first.places, first.dofs, first.tendons
        self._own = first.own
        fields = ("dof_armature", "dof_damping", "tendon_armature", "tendon_damping")
        self._fields = [self.batch.expand(name) for name in fields]
        names = ("qpos", "qvel", "qacc", "qfrc_applied")
        self._q, self._v, self._acceleration, self._force = (self.batch.bind(name) for name in names)
        self.inertia = np.tile(schedule.chain.inertia, (count, 1))
        self.damping = np.tile(schedule.chain.damping, (count, 1))
        self.outside = np.zeros(count, bool)

    def put(self, position: np.ndarray, velocity: np.ndarray) -> None:
        """Set every world's state, serial coordinates (N, n)."""
        self._q[:, self._places], self._v[:, self._dofs] = position, velocity

    def state(self) -> State:
        """Positions and velocities in serial coordinates, (N, n) each."""
        return self._q[:, self._places].copy(), self._v[:, self._dofs].copy()

    def step(self, torque: np.ndarray, steps: int = 1) -> None:
        """Take `steps` steps under torques on the drives (N, n) [N m].

        Raises:
            SimulationError: a world leaves the limits (unless the schedule holds there).
        """
        armature, damping, pair_armature, pair_damping = self._fields
        for done in range(0, steps, self.hold):
            q, v = self.state()
            self.outside = ~self.schedule.chain.inside(q)
            self.schedule.check(q)
            soon = looking_ahead(q, v, self._acceleration[:, self._dofs], self.ahead)
            f = self.schedule.at(*soon, torque, inertia=self.inertia, damping=self.damping)
            armature[:, self._dofs] = self._own[0] + f.armature
            damping[:, self._dofs] = self._own[1] + f.damping
            pair_armature[:, self._tendons] = f.pair_armature
            pair_damping[:, self._tendons] = f.pair_damping
            self._force[:, self._dofs] = f.torque
            self.batch.step(nstep=min(self.hold, steps - done))


def _inside(m: mujoco.MjModel, schedule: Schedule) -> State:
    """The MJCF's own posture at rest, moved into the limits."""
    q = np.array([m.qpos0[m.joint(name).qposadr[0]] for name in schedule.model.joints])
    return np.clip(q, *schedule.chain.box.T), np.zeros(len(q))
