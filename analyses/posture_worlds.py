"""A world whose fields are written at every step: in plain MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
from posture_schedule import Schedule, pair_tendon

from workbench.core import SimulationError
from workbench.s3n.worlds import State, World


class ScheduledWorld(World):
    """One world in plain MuJoCo; fields are written every `hold` steps.

    Args:
        schedule: what to write.
        step: integration step [s].
        integrator: of MuJoCo.
        start: ``(q, v)`` in serial coordinates, or None for the MJCF's own posture at rest.
        hold: steps between two writes.

    Raises:
        InputError: no such integrator.
        SimulationError: a start outside the limits.
    """

    def __init__(
        self,
        schedule: Schedule,
        step: float = 0.001,
        integrator: str = "implicitfast",
        start: State | None = None,
        hold: int = 1,
    ) -> None:
        model = schedule.model
        super().__init__(schedule.spec(step, integrator).compile(), model.joints, np.eye(model.size), start)
        self.schedule, self.hold = schedule, hold
        self.tendons = _tendons(self.m, schedule)
        self.own = self.m.dof_armature[self.dofs].copy(), self.m.dof_damping[self.dofs].copy()
        self.ahead = look_ahead(step, integrator, hold)
        self.m.dof_simplenum[:] = 0  # of links that turn about their centres MuJoCo would keep M
        self._write(np.zeros(model.size))
        settle(self.m)

    def advance(self, torque: np.ndarray, steps: int) -> None:
        """Take `steps` steps with a constant torque on the drives (n,).

        Raises:
            SimulationError: a joint leaves its limits; says when.
        """
        done = 0
        while done < steps:
            self._write(torque)
            count = min(self.hold, steps - done)
            mujoco.mj_step(self.m, self.data, count)
            done += count

    def acceleration(self, position: np.ndarray, velocity: np.ndarray, torque: np.ndarray) -> np.ndarray:
        """Return MuJoCo's acceleration (n,) for a state and torque on the drives; the world stays there."""
        self.put(position, velocity)
        self.data.qacc[:] = 0.0
        self._write(torque)
        mujoco.mj_forward(self.m, self.data)
        return self.data.qacc[self.dofs].copy()

    def _write(self, torque: np.ndarray) -> None:
        q, v = self.state()
        q, v = q[None], v[None]
        try:
            self.schedule.check(q)
            soon = looking_ahead(q, v, self.data.qacc[None, self.dofs], self.ahead)
            f = self.schedule.at(*soon, torque[None])
        except SimulationError as error:
            raise SimulationError(f"t = {self.data.time:.4f} s: {error}") from error
        m = self.m
        m.dof_armature[self.dofs] = self.own[0] + f.armature[0]
        m.dof_damping[self.dofs] = self.own[1] + f.damping[0]
        m.tendon_armature[self.tendons] = f.pair_armature[0]
        m.tendon_damping[self.tendons] = f.pair_damping[0]
        self.data.qfrc_applied[self.dofs] = f.torque[0]


def look_ahead(step: float, integrator: str, hold: int) -> float:
    """Return the time [s] from a write to the middle of the evaluations that use it."""
    return step * (hold if integrator == "RK4" else hold - 1) / 2.0


def looking_ahead(q: np.ndarray, v: np.ndarray, a: np.ndarray, ahead: float) -> State:
    """Return positions and rates (N, n) `ahead` [s] later, by acceleration `a` of the preceding step.

    Off by the square of the step where the torque does not jump, so that what is held over a step errs by
    the step's square.
    """
    return q + ahead * v, v + ahead * a


def _tendons(m: mujoco.MjModel, schedule: Schedule) -> np.ndarray:
    return np.array([m.tendon(pair_tendon(*pair)).id for pair in schedule.pairs], int)


def settle(m: mujoco.MjModel) -> None:
    """Let MuJoCo recompute its own scales of constraints after the fields were written."""
    mujoco.mj_setConst(m, mujoco.MjData(m))
