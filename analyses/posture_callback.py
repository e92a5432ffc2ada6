"""The closed chain's inertia added to MuJoCo's own at every evaluation, by its passive-force callback.

MuJoCo builds the mass matrix from positions and calls ``mjcb_passive`` before it uses it, so the callback
can add dM(q) to it and factor it anew. This is exact inside every stage of ``RK4`` too. It is no way to
train: the callback is one for the whole process, it calls Python at every stage, `mujoco.batch` and GPUs
refuse it, and constraints do not see it everywhere (islands and PGS copy the mass matrix beforehand). Drag
is explicit here. So it only stands beside the ways that one can train with.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco
import numpy as np
from posture_schedule import Schedule

from workbench.core import InputError
from workbench.s3n.worlds import State, World


class CallbackWorld(World):
    """One world whose inertia follows the posture within a step.

    Args:
        schedule: what the closed chain has beyond the serial tree.
        step: integration step [s].
        integrator: of MuJoCo.
        start: ``(q, v)`` in serial coordinates, or None for the MJCF's own posture at rest.

    Raises:
        InputError: no such integrator, or joints whose entry the mass matrix does not have.
    """

    def __init__(
        self,
        schedule: Schedule,
        step: float = 0.001,
        integrator: str = "RK4",
        start: State | None = None,
    ) -> None:
        spec = schedule.spec(step, integrator)
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ISLAND)
        model = schedule.model
        super().__init__(spec.compile(), model.joints, np.eye(model.size), start)
        self.schedule = schedule
        self._where = _entries(self.m, self.dofs)
        self._lower = np.tril_indices(model.size)
        self._torque = np.zeros(model.size)
        self._failed: Exception | None = None

    def advance(self, torque: np.ndarray, steps: int) -> None:
        """Take `steps` steps under a torque on the drives (n,).

        Raises:
            SimulationError: a joint leaves its limits.
        """
        self._torque = np.asarray(torque, float)
        with self._installed():
            for _ in range(steps):
                mujoco.mj_step(self.m, self.data)
                if self._failed is not None:
                    error, self._failed = self._failed, None
                    raise error

    def forward(self, torque: np.ndarray) -> np.ndarray:
        """Acceleration (n,) under a torque on the drives (n,) at the state."""
        self._torque = np.asarray(torque, float)
        with self._installed():
            mujoco.mj_forward(self.m, self.data)
        return self.data.qacc[self.dofs].copy()

    @contextmanager
    def _installed(self) -> Iterator[None]:
        before = mujoco.get_mjcb_passive()
        mujoco.set_mjcb_passive(self._passive)
        try:
            yield
        finally:
            mujoco.set_mjcb_passive(before)

    def _passive(self, m: mujoco.MjModel, d: mujoco.MjData) -> None:
        # an exception cannot pass through MuJoCo's C code
        try:
            self._add(m, d)
        except Exception as error:
            self._failed = error

    def _add(self, m: mujoco.MjModel, d: mujoco.MjData) -> None:
        q, v = d.qpos[None, self.places], d.qvel[None, self.dofs]
        self.schedule.check(q)
        f = self.schedule.at(q, v, self._torque[None])
        matrices = []
        for own, pairs in ((f.armature[0], f.pair_armature[0]), (f.damping[0], f.pair_damping[0])):
            full = np.diag(own)
            for (i, j), x in zip(self.schedule.pairs, pairs, strict=True):
                full[[i, i, j, j], [i, j, i, j]] += x
            matrices.append(full)
        d.M[self._where] += matrices[0][self._lower]
        mujoco.mj_factorM(m, d)
        d.qfrc_passive[self.dofs] += f.torque[0] - matrices[1] @ v[0]


def _entries(m: mujoco.MjModel, dofs: np.ndarray) -> np.ndarray:
    """Places in ``MjData.M`` of the lower triangle over `dofs`, row by row.

    Raises:
        InputError: two joints are in different branches of the tree, so that M has no entry for them.
    """
    out = []
    for i, row in enumerate(dofs):
        first, count = m.M_rowadr[row], m.M_rownnz[row]
        columns = list(m.M_colind[first : first + count])
        for column in dofs[: i + 1]:
            if int(column) not in columns:
                raise InputError(
                    "the mechanism's joints are in different branches of the tree",
                    remedy="use the scheduled variant",
                )
            out.append(first + columns.index(int(column)))
    return np.array(out)
