"""A mechanism's loops closed in MuJoCo at serial joint positions, on the start posture's branch.

The loops are cut, which leaves a tree with coordinates theta (N,); `core.closure` solves them with the serial
joints as independent coordinates. Where phi_d loses rank the joints do not determine the drives; where J, the
rows of L that are the drives', does, the drives hold still while the joints move. Both are singular postures,
and refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.core import InputError, SimulationError
from workbench.core.closure import Closure
from workbench.core.closure import Posture as ClosedPosture
from workbench.core.moving import moving_with
from workbench.models import Model

from .loop import bound_joints, close_loops, loop_spec, mechanism_of

_SINGULAR = 1e-6  # margin below which a posture counts as singular


@dataclass(frozen=True)
class Posture:
    """A closed posture of the cut tree that is not singular.

    Attributes:
        theta: coordinates of the tree (N,).
        inverse: of d gap / d dependent coordinates, the pseudo-inverse (N - n, 3 m).
        slope: L, d theta / d q (N, n).
        jacobian: J, d q_p / d q (n, n) (paper, Eq. 1).
        margin: how far from singular, 1 at best: the lesser of smallest over largest singular value of
            d gap / d dependent coordinates and of `jacobian`.
    """

    theta: np.ndarray
    inverse: np.ndarray
    slope: np.ndarray
    jacobian: np.ndarray
    margin: float


class LoopClosure:
    """The cut tree of a model's closed chain, links only, moved along closed postures.

    Args:
        model: names the closed chain; its start posture picks the branch.

    Raises:
        InputError: it names none, or no loops, or they do not close at the start posture.
    """

    def __init__(self, model: Model) -> None:
        mechanism = mechanism_of(model)
        if not mechanism.loops and not mechanism.all_couplings():
            raise InputError(
                f"model '{model.name}' names no loops", file=model.source, column="closed_chain.loops",
                remedy="name the pairs of frames that coincide where the loops are closed",
            )  # fmt: skip
        self.model, self.m = model, loop_spec(model, None).compile()
        # rotors and their drag act through J, beside the links
        self.m.dof_armature[:], self.m.dof_damping[:] = 0.0, 0.0
        self.m.dof_simplenum[:] = (
            0  # of links that turn about their centres MuJoCo keeps M with the rotor in it
        )
        self.data = mujoco.MjData(self.m)
        self.serial = [int(self.m.joint(name).dofadr[0]) for name in mechanism.joints]
        self.drives = [int(self.m.joint(name).dofadr[0]) for name in mechanism.drives]
        self.names = [self.m.joint(int(k)).name for k in self.m.dof_jntid]
        self._loops = [tuple(self.m.site(name).id for name in pair) for pair in mechanism.loops]
        self._bound = bound_joints(self.m, mechanism)
        self._jacobians = np.zeros((2, 3, self.m.nv))
        self._moving = moving_with(self._movers(), [*self.serial, *self.drives])
        self._closure = self._first(_start(model))

    def moving(self) -> tuple[float, float]:
        """Return how large what moves is [m]: the longest way between two points of a link; and its mass."""
        m, way, mass = self.m, [0.0], 0.0
        moves = {int(m.dof_bodyid[k]) for k in self._moving[1]}
        for body in range(1, m.nbody):
            if int(m.body_parentid[body]) in moves:
                moves.add(body)
                way.append(float(np.linalg.norm(m.body_pos[body])))
            if body in moves:
                mass += float(m.body_mass[body])
        way += [
            float(np.linalg.norm(m.site_pos[s])) for s in range(m.nsite) if int(m.site_bodyid[s]) in moves
        ]
        way += [float(np.linalg.norm(m.body_ipos[body])) for body in moves]
        return max(way), mass

    def at(self, q: np.ndarray) -> Posture:
        """Return the closed posture at serial positions `q` (n,) [rad or m]; the tree is left there.

        Raises:
            SimulationError: the loops cannot be closed there, or the posture is singular; names the joints.
        """
        try:
            found = self._closure.at(np.array(q, float))
        except SimulationError as error:
            raise SimulationError(f"model '{self.model.name}': {error}") from error
        why, posture = self._regular(found)
        if posture is None:
            raise SimulationError(f"model '{self.model.name}': {why} at {say(self.model, q)}")
        return posture

    @property
    def start(self) -> ClosedPosture:
        """Return the closed posture from which all others are reached."""
        return self._closure.at(self._begun)

    def along(self, origin: ClosedPosture, q: np.ndarray) -> ClosedPosture | None:
        """Return the closed posture at `q` (n,), reached straight from `origin`; None if that fails."""
        return self._closure.along(origin, q)

    def gamma(self, posture: Posture, rates: np.ndarray) -> np.ndarray:
        """Return the tree's acceleration (N,) at a posture and rates (N,) if joints do not accelerate."""
        self.data.qvel[:] = rates
        mujoco.mj_comVel(self.m, self.data)
        return self._closure.gamma(posture.inverse)

    def move(self, theta: np.ndarray) -> None:
        """Move to the posture theta (N,) [rad or m]."""
        self.data.qpos[:] = theta
        mujoco.mj_kinematics(self.m, self.data)
        mujoco.mj_comPos(self.m, self.data)

    def gap(self, rows: Sequence[int] | None = None) -> np.ndarray:
        """Return gaps of m loops [m], then errors of k couplings, (3 m + k,); with `rows` those alone."""
        at = self.data.site_xpos
        out = np.concatenate([*(at[a] - at[b] for a, b in self._loops), self._bound.gap(self.data.qpos)])
        return out if rows is None else out[list(rows)]

    def gap_jacobian(self, rows: Sequence[int] | None = None) -> np.ndarray:
        """d gap / d theta (3 m + k, N); with `rows` those alone."""
        out = np.zeros((3 * len(self._loops) + len(self._bound.pairs), self.m.nv))
        for k in self._needed(rows):
            for matrix, site in zip(self._jacobians, self._loops[k], strict=True):
                mujoco.mj_jacSite(self.m, self.data, matrix, None, site)
            out[3 * k : 3 * k + 3] = self._jacobians[0] - self._jacobians[1]
        out[3 * len(self._loops) :] = self._bound.jacobian(self.data.qpos)
        return out if rows is None else out[list(rows)]

    def gap_bias(self, rows: Sequence[int] | None = None) -> np.ndarray:
        """Second derivative of the gap at zero acceleration of the tree (3 m + k,); or `rows` alone."""
        m, d = self.m, self.data
        out = np.zeros((len(self._loops), 3))
        for k in self._needed(rows):
            for matrix, site in zip(self._jacobians, self._loops[k], strict=True):
                mujoco.mj_jacDot(m, d, matrix, None, d.site_xpos[site], m.site_bodyid[site])
            out[k] = (self._jacobians[0] - self._jacobians[1]) @ d.qvel
        every = np.concatenate([out.ravel(), self._bound.bias(d.qpos, d.qvel)])
        return every if rows is None else every[list(rows)]

    def _needed(self, rows: Sequence[int] | None) -> Iterable[int]:
        """Loops that rows of the gap are of."""
        own = range(len(self._loops))
        return own if rows is None else sorted({row // 3 for row in rows} & set(own))

    def _movers(self) -> list[list[int]]:
        """Of each row of the gap (3 m + k) the coordinates that open or close it."""
        m = self.m

        def inboard(site: int) -> set[int]:
            out, body = set[int](), int(m.site_bodyid[site])
            while body:
                first = int(m.body_dofadr[body])
                out |= set(range(first, first + int(m.body_dofnum[body])))
                body = int(m.body_parentid[body])
            return out

        loops = [sorted(inboard(a) ^ inboard(b)) for a, b in self._loops]
        bound = [sorted({a} if b is None else {a, b}) for _, a, b in self._bound.pairs]
        return [*(loop for loop in loops for _ in range(3)), *bound]

    def _first(self, q: np.ndarray) -> Closure:
        """Return the loops, closed at the posture from which all others are reached."""
        try:
            near = close_loops(self.m, self.model, q, np.zeros_like(q))[0]
            theta = Closure(self, self.serial, near).solve(near)
        except SimulationError:
            theta = None
        if theta is None:
            raise InputError(
                f"the loops do not close at {say(self.model, q)}", file=mechanism_of(self.model).file,
                column="closed_chain.start", remedy="give the joints' angles near a closed posture",
            )  # fmt: skip
        closure = Closure(self, self.serial, theta, through=False, moving=self._moving)
        self._begun = theta[self.serial]
        why, posture = self._regular(closure.at(theta[self.serial]))
        if posture is None:
            raise InputError(
                f"at the start posture {why}", file=mechanism_of(self.model).file,
                column="closed_chain.start", remedy="give angles away from it",
            )  # fmt: skip
        return closure

    def _regular(self, found: ClosedPosture) -> tuple[str, Posture | None]:
        """Return the posture, or why it is singular."""
        if found.slope is not None and found.inverse is not None:
            jacobian = found.slope[self.drives]
            own = np.linalg.svd(jacobian, compute_uv=False)
            margin = float(min(found.margin, own[-1] / own[0]))
            if margin >= _SINGULAR:
                return "", Posture(found.theta, found.inverse, found.slope, jacobian, margin)
            if margin < found.margin:
                return "the drives are at a dead point (J is singular)", None
        return "the joints do not determine the drives (a loop is at a dead point)", None


def workspace(model: Model) -> np.ndarray:
    """Return the lower and upper limit of each serial joint (n, 2) [rad or m].

    Raises:
        InputError: the closed chain states none.
    """
    limits = mechanism_of(model).limits
    if not limits:
        raise InputError(
            f"model '{model.name}' has no limits", file=model.source, column="closed_chain.limits",
            remedy="give the workspace: a lower and an upper limit for each serial joint",
        )  # fmt: skip
    return np.array(limits, float)


def say(model: Model, q: np.ndarray) -> str:
    """Return serial positions (n,) by joint, for messages: ``hip = 0.4, knee = 2.6 rad``."""
    return ", ".join(f"{name} = {x:.4g}" for name, x in zip(model.joints, q, strict=True))


def _start(model: Model) -> np.ndarray:
    """Return serial positions to begin at: the start posture, or the middle if J is constant."""
    mechanism = mechanism_of(model)
    known = dict(mechanism.start)
    stated = np.array([known.get(name, 0.0) for name in mechanism.joints])
    if not mechanism.limits:
        return stated
    low, high = workspace(model).T
    return np.clip(stated, low, high) if model.posture_dependent else (low + high) / 2.0
