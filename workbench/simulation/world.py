"""The mechanisms of W runs in MuJoCo, stepped together, and the torque chain in front of them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco.batch import MODEL_FIELDS, Batch

from workbench.effects import Plant

from .experiment import Experiment

_APPLIED = mujoco.mjtState.mjSTATE_QFRC_APPLIED.value
_TOO_FAST = 1e4  # rad/s or m/s: a run that goes faster is lost


@dataclass
class _Law:
    """One friction law on one tendon for some runs of a group."""

    members: np.ndarray
    tendon: int
    axis: np.ndarray
    law: Callable[..., np.ndarray]
    parameters: np.ndarray


class _Group:
    """Runs whose MuJoCo models have one layout, in one batch; `members` are their run numbers, ascending."""

    def __init__(self, plants: list[Plant], members: np.ndarray, start: np.ndarray) -> None:
        first, self.members = plants[0], members
        models = [p.mujoco for p in plants]
        names = first.model.joints
        self.batch = Batch(models[0], len(models))
        _spread(self.batch, models)
        self.columns = np.array([models[0].joint(name).qposadr[0] for name in names])
        self.dofs = np.array([models[0].joint(name).dofadr[0] for name in names])
        self.batch.bind("qpos")[:, self.columns] = start[:, 0]
        self.batch.bind("qvel")[:, self.dofs] = start[:, 1]
        self.give = np.stack([_give(m, self.dofs) for m in models])
        self.laws = _laws(plants, models[0])
        self.before = start[:, 1].copy()
        if self.laws:
            self.loss = self.batch.expand("tendon_frictionloss")
            self.constant = self.loss.copy()

    def step(self, torque: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Advance the first `count` runs by the steps of `torque` (count, c, n), joint coordinates."""
        applied = np.zeros((count, torque.shape[1], self.batch.model.nv))
        applied[:, :, self.dofs] = torque
        ids = None if count == self.batch.nsim else np.arange(count)
        if not self.laws:
            out = self.batch.rollout(torque.shape[1], applied, _APPLIED, ("qpos", "qvel"), ids)
            return out["qpos"][:, :, self.columns], out["qvel"][:, :, self.dofs]
        q, w = np.empty_like(torque), np.empty_like(torque)
        force, qpos, qvel = (self.batch.bind(name) for name in ("qfrc_applied", "qpos", "qvel"))
        for k in range(torque.shape[1]):
            force[:count] = applied[:, k]
            now = qvel[:count][:, self.dofs]
            self._set_friction(1.5 * now - 0.5 * self.before[:count], torque[:, k])
            self.before[:count] = now
            self.batch.step(ids)
            q[:, k], w[:, k] = qpos[:count][:, self.columns], qvel[:count][:, self.dofs]
        return q, w

    def shift(self, torque: np.ndarray, count: int) -> np.ndarray:
        """Move the first `count` runs by M^-1 `torque` (count, n) [N m s^2]; returns their positions."""
        qpos = self.batch.bind("qpos")
        qpos[:count, self.columns] += np.einsum("wij,wj->wi", self.give[:count], torque)
        return qpos[:count][:, self.columns]

    def rest(self, lost: np.ndarray) -> None:
        """Put runs (indices) to rest, where they do no harm."""
        self.batch.bind("qpos")[lost] = self.batch.model.qpos0
        self.batch.bind("qvel")[lost] = 0.0

    def _set_friction(self, speed: np.ndarray, torque: np.ndarray) -> None:
        """Friction bounds at the middle of the coming step, by extrapolating the speed half a step."""
        count = len(speed)
        self.loss[:count] = self.constant[:count]
        for law in self.laws:
            live = law.members < count
            m = law.members[live]
            along = np.einsum("mi,mi->m", law.axis[live], speed[m])
            drive = np.einsum("mi,mi->m", law.axis[live], torque[m])
            self.loss[m, law.tendon] += law.law(along, drive, *law.parameters[live].T)


class Worlds:
    """All groups behind one face; arrays are over the W runs, longest first."""

    def __init__(
        self, groups: list[_Group], plants: Sequence[Plant], experiments: Sequence[Experiment]
    ) -> None:
        self.groups, self.count, self.size = groups, len(plants), plants[0].model.size
        step = self.step_s = experiments[0].step
        self.early: np.ndarray | None = None
        # where a loop's log already carries the delay it has been applied all the same, only before the log
        pairs = zip(plants, experiments, strict=True)
        delay = np.array([e.delay(p.chain.delay_s, p.model) for p, e in pairs]) / step
        self.whole = np.floor(delay + 1e-9).astype(int)
        self.fraction = np.where(delay - self.whole > 1e-9, delay - self.whole, 0.0)[:, None, None]
        self.longest_delay = int(self.whole.max()) + 1
        self.start = np.stack([e.start for e in experiments])
        self.limit, self.gain, self.bias = (
            np.stack([getattr(p.chain, name) for p in plants])[:, None] for name in ("limit", "gain", "bias")
        )
        self.transmission = np.stack([p.model.transmission for p in plants])
        self.lost = np.zeros(len(plants), bool)

    def chain(
        self, command: np.ndarray, first: int, last: int, active: int, pad: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """The torque chain over a chunk of substeps, in the order of the doors.

        Args:
            command: (W, pad + K + 1, n), zero before the first command.
            first, last: chunk of substeps.
            active: the first `active` runs.
            pad: rows before substep 0.

        Returns:
            ``(tap, torque)``: `torque_measured` just after each substep's time, (active, c + 1, n), and
            the mean torque on the joints over each step, (active, c, n).
        """
        steps = np.arange(first, last + 1)[None, :] - self.whole[:active, None] + pad
        index = np.arange(active)[:, None]
        newer, older = command[index, steps], command[index, steps - 1]
        fraction, limit = self.fraction[:active], self.limit[:active]
        tap = np.clip(np.where(fraction > 0, older, newer), -limit, limit)
        mean = np.clip(newer, -limit, limit) * (1 - fraction) + np.clip(older, -limit, limit) * fraction
        shaft = self.gain[:active] * mean[:, :-1] + self.bias[:active]
        self.early = None
        if fraction.any():
            # a mean torque has the right impulse, but a step edge inside a step also moves the position
            edge = (np.clip(older, -limit, limit) - np.clip(newer, -limit, limit))[:, :-1].sum(axis=1)
            share = 0.5 * self.step_s**2 * (fraction * (1.0 - fraction))[:, 0]
            moved = share * self.gain[:active, 0] * edge
            self.early = np.einsum("wi,wij->wj", moved, self.transmission[:active])
        return tap, shaft @ self.transmission[:active]

    def step(self, torque: np.ndarray, active: int) -> tuple[np.ndarray, np.ndarray]:
        """Advance the first `active` runs; returns joint positions and rates after each substep."""
        q, w = np.full_like(torque, np.nan), np.full_like(torque, np.nan)
        torque = np.where(self.lost[:active, None, None], 0.0, torque)
        for group in self.groups:
            count = int(np.searchsorted(group.members, active))
            if count == 0:
                continue
            members = group.members[:count]
            q[members], w[members] = group.step(torque[members], count)
            if self.early is not None:
                q[members, -1] = group.shift(self.early[members], count)
            self.lost[members] |= ~(np.abs(w[members]) < _TOO_FAST).all(axis=(1, 2))
            if self.lost[members].any():
                group.rest(np.flatnonzero(self.lost[members]))
        q[self.lost[:active]], w[self.lost[:active]] = np.nan, np.nan
        return q, w


def group_worlds(plants: Sequence[Plant], experiments: Sequence[Experiment]) -> Worlds:
    """Put runs into batches by the layout of their MuJoCo models and the friction laws they need."""
    groups: dict[tuple[object, ...], list[int]] = defaultdict(list)
    for i, plant in enumerate(plants):
        m = plant.mujoco
        counts = (m.nq, m.nv, m.nbody, m.ngeom, m.nsite, m.ntendon, m.neq, m.nM, bool(plant.chain.friction))
        layout = (*counts, plant.model.serial, plant.model.joints, plant.model.transmission.tobytes())
        groups[layout].append(i)
    starts = np.stack([e.start for e in experiments])
    made = [_Group([plants[i] for i in ids], np.array(ids), starts[ids]) for ids in groups.values()]
    return Worlds(made, plants, experiments)


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


def _give(model: mujoco.MjModel, dofs: np.ndarray) -> np.ndarray:
    """Inverse mass matrix of some joints at the model's initial posture."""
    data, full = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, full)
    return np.linalg.inv(full)[np.ix_(dofs, dofs)]


def _laws(plants: list[Plant], model: mujoco.MjModel) -> list[_Law]:
    found: dict[tuple[str, Callable[..., np.ndarray]], list[tuple[int, tuple[float, ...]]]] = defaultdict(
        list
    )
    for i, plant in enumerate(plants):
        for term in plant.chain.friction:
            found[term.tendon, term.law].append((i, term.parameters))
    laws = []
    for (tendon, law), entries in found.items():
        location, index = tendon.split(":")
        rows = [
            plants[i].model.transmission[int(index)]
            if location == "actuator"
            else np.eye(plants[i].model.size)[int(index)]
            for i, _ in entries
        ]
        laws.append(
            _Law(
                np.array([i for i, _ in entries]),
                model.tendon(tendon).id,
                np.array(rows),
                law,
                np.array([p for _, p in entries]),
            )
        )
    return laws
