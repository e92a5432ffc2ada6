"""The mechanisms of W runs in MuJoCo, stepped together."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import mujoco
import numpy as np
from mujoco.batch import MODEL_FIELDS, Batch

from workbench.effects import Plant

from .laws import Laws

_APPLIED = mujoco.mjtState.mjSTATE_QFRC_APPLIED.value
_TOO_FAST = 1e4  # rad/s or m/s: a run that goes faster is lost


class _Group:
    """Runs whose MuJoCo models have one layout, in one batch; `members` are their run numbers, ascending."""

    def __init__(self, plants: list[Plant], members: np.ndarray, start: np.ndarray) -> None:
        first, self.members = plants[0], members
        models = [p.mujoco for p in plants]
        self.batch = Batch(models[0], len(models))
        _spread(self.batch, models)
        self.drives = first.drives
        state = np.stack([p.state_at(s) for p, s in zip(plants, start, strict=True)])
        self.batch.bind("qpos")[:], self.batch.bind("qvel")[:] = state[:, 0], state[:, 1]
        self.give = np.stack([_give(p) for p in plants])
        self.substeps = first.substeps
        self.laws = Laws(plants, self.batch, first.mujoco.opt.timestep)

    def step(self, shaft: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Advance the first `count` runs by the steps of `shaft` (count, c, n), torque on the drives.

        Returns:
            Positions and speeds of the drives after each step, (count, c, n) each.
        """
        many = self.substeps
        applied = shaft @ self.drives
        ids = None if count == self.batch.nsim else np.arange(count)
        if not self.laws.present:
            applied = np.repeat(applied, many, axis=1) if many > 1 else applied
            out = self.batch.rollout(applied.shape[1], applied, _APPLIED, ("qpos", "qvel"), ids)
            q, w = (out[name][:, many - 1 :: many] @ self.drives.T for name in ("qpos", "qvel"))
            return q, w
        q, w = np.empty_like(shaft), np.empty_like(shaft)
        force, qpos, qvel = (self.batch.bind(name) for name in ("qfrc_applied", "qpos", "qvel"))
        for k in range(shaft.shape[1]):
            for _ in range(many):
                force[:count] = applied[:, k]
                self.laws.apply(qpos[:count], qvel[:count].copy(), shaft[:, k], force)
                self.batch.step(ids)
            q[:, k], w[:, k] = qpos[:count] @ self.drives.T, qvel[:count] @ self.drives.T
        return q, w

    def shift(self, early: np.ndarray, count: int) -> np.ndarray:
        """Move the first `count` runs by M^-1 `early` (count, n) [N m s^2]; returns the drives' positions."""
        qpos = self.batch.bind("qpos")
        qpos[:count] += np.einsum("wij,wj->wi", self.give[:count], early)
        return qpos[:count] @ self.drives.T

    def rest(self, lost: np.ndarray) -> None:
        """Put runs (indices) to rest, where they do no harm."""
        self.batch.bind("qpos")[lost] = self.batch.model.qpos0
        self.batch.bind("qvel")[lost] = 0.0


class Worlds:
    """All groups behind one face; arrays are over the W runs, longest first, in actuator coordinates."""

    def __init__(self, groups: list[_Group], plants: Sequence[Plant]) -> None:
        self.groups, self.count, self.size = groups, len(plants), plants[0].model.size
        self.lost = np.zeros(len(plants), bool)

    def step(self, shaft: np.ndarray, early: np.ndarray | None, active: int) -> tuple[np.ndarray, np.ndarray]:
        """Advance the first `active` runs.

        Args:
            shaft: torque on the drives, the mean over each substep, (active, c, n).
            early: moment of the impulses inside the chunk [N m s^2], (active, n), or None.
            active: number of runs.

        Returns:
            Positions and speeds of the drives after each substep, (active, c, n) each.
        """
        q, w = np.full_like(shaft, np.nan), np.full_like(shaft, np.nan)
        shaft = np.where(self.lost[:active, None, None], 0.0, shaft)
        for group in self.groups:
            count = int(np.searchsorted(group.members, active))
            if count == 0:
                continue
            members = group.members[:count]
            q[members], w[members] = group.step(shaft[members], count)
            if early is not None:
                q[members, -1] = group.shift(early[members], count)
            self.lost[members] |= ~(np.abs(w[members]) < _TOO_FAST).all(axis=(1, 2))
            if self.lost[members].any():
                group.rest(np.flatnonzero(self.lost[members]))
        q[self.lost[:active]], w[self.lost[:active]] = np.nan, np.nan
        return q, w


def group_worlds(plants: Sequence[Plant], starts: np.ndarray) -> Worlds:
    """Put runs into batches by the layout of their MuJoCo models and the laws they need.

    `starts`: position and rate of the serial joints that each run starts with, (W, 2, n).
    """
    groups: dict[tuple[object, ...], list[int]] = defaultdict(list)
    for i, plant in enumerate(plants):
        shapes = (getattr(plant.mujoco, name).shape for name in MODEL_FIELDS if not name.startswith("opt."))
        machine = plant.model.serial, plant.model.joints, plant.drives.tobytes()
        groups[*shapes, *machine, plant.substeps, plant.chain.follows_state].append(i)
    made = [_Group([plants[i] for i in ids], np.array(ids), starts[ids]) for ids in groups.values()]
    return Worlds(made, plants)


def _spread(batch: Batch, models: list[mujoco.MjModel]) -> None:
    """Give every run its own values of the model fields that differ between runs."""
    first = models[0]
    distinct = {id(m): m for m in models}
    for name in MODEL_FIELDS:
        if name.startswith("opt."):
            continue
        base = getattr(first, name)
        if any(not np.array_equal(base, getattr(m, name)) for m in distinct.values()):
            own = batch.expand(name)
            for i, model in enumerate(models):
                own[i] = getattr(model, name)


def _give(plant: Plant) -> np.ndarray:
    """Rate of the joints (nv, n) that an impulse on each drive makes, at the model's initial posture."""
    m = plant.mujoco
    data, full = mujoco.MjData(m), np.zeros((m.nv, m.nv))
    mujoco.mj_forward(m, data)
    mujoco.mj_fullM(m, data, full)
    return np.linalg.solve(full, plant.drives.T)
