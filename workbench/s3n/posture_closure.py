"""A mechanism's loops closed in MuJoCo at serial joint positions: which way the rest of it goes.

The loops are cut, which leaves a tree with coordinates theta (N,). With the serial joints q as independent
coordinates, the others d as dependent ones and phi(theta) the gaps of all loops,

    theta_dot  = L q_dot,            L = [I; -phi_d^+ phi_q]
    theta_ddot = L q_ddot + gamma,   gamma = [0; -phi_d^+ phi_dot_theta theta_dot].

A loop has more than one solution, so a posture is followed from a known one along L and never looked for
afresh. Where phi_d loses rank the joints do not determine the drives; where J, the rows of L that are the
drives', does, the drives hold still while the joints move. Both are singular postures, and refused.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.core import InputError, SimulationError
from workbench.models import Model

from .bound_joints import BoundJoints
from .loop import close_loops, loop_spec, mechanism_of

_CLOSED = 1e-10  # m, largest gap that counts as closed
_SINGULAR = 1e-6  # margin below which a posture counts as singular
_NEAR = 0.2  # rad or m: a posture this close to the last one is followed from there, else from the start
_SHORTEST = 2.0**-12  # part of the way below which following gives up


@dataclass(frozen=True)
class Posture:
    """A closed posture of the cut tree.

    Attributes:
        q: serial joint positions (n,) [rad or m].
        theta: coordinates of the tree (N,).
        gap_d: d gap / d dependent coordinates (3 m, N - n).
        inverse: its pseudo-inverse (N - n, 3 m).
        slope: L, d theta / d q (N, n).
        jacobian: J, d q_p / d q (n, n) (paper, Eq. 1).
        margin: how far from singular, 1 at best: the lesser of smallest over largest singular value of
            `gap_d` and of `jacobian`.
    """

    q: np.ndarray
    theta: np.ndarray
    gap_d: np.ndarray
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
        self.dependent = [i for i in range(self.m.nv) if i not in self.serial]
        self._loops = [tuple(self.m.site(name).id for name in pair) for pair in mechanism.loops]
        self._bound = BoundJoints.of(self.m, mechanism)
        self._jacobians = np.zeros((2, 3, self.m.nv))
        self._start = self._last = self._first(_start(model))

    def at(self, q: np.ndarray) -> Posture:
        """The closed posture at serial positions `q` (n,) [rad or m]; the tree is left there.

        Raises:
            SimulationError: the loops cannot be closed there, or the posture is singular; names the joints.
        """
        q = np.array(q, float)
        near = np.abs(q - self._last.q).max() < _NEAR
        for origin in (self._last, self._start) if near else (self._start, self._last):
            found = self._follow(origin, q)
            if found is not None:
                if found.margin < _SINGULAR:
                    raise SimulationError(f"model '{self.model.name}': {self._why(found)} at {self.say(q)}")
                self._last = found
                return found
        raise SimulationError(
            f"model '{self.model.name}': the loops cannot be closed at {self.say(q)}, or not without passing "
            "a singular posture"
        )

    def gap_bias(self, rates: np.ndarray) -> np.ndarray:
        """Second derivative of all gaps at zero acceleration, couplings last, (3 m + k,), at rates (N,)."""
        m, d = self.m, self.data
        d.qvel[:] = rates
        mujoco.mj_comVel(m, d)
        out = []
        for pair in self._loops:
            for matrix, site in zip(self._jacobians, pair, strict=True):
                mujoco.mj_jacDot(m, d, matrix, None, d.site_xpos[site], m.site_bodyid[site])
            out.append((self._jacobians[0] - self._jacobians[1]) @ rates)
        return np.concatenate([*out, self._bound.bias(d.qpos, rates)])

    def say(self, q: np.ndarray) -> str:
        """Serial positions by joint, for messages."""
        return say(self.model, q)

    def _first(self, q: np.ndarray) -> Posture:
        try:
            theta = self._solve(close_loops(self.m, self.model, q, np.zeros_like(q))[0])
        except SimulationError:
            theta = None
        if theta is None:
            raise InputError(
                f"the loops do not close at {self.say(q)}", file=mechanism_of(self.model).file,
                column="closed_chain.start", remedy="give the joints' angles near a closed posture",
            )  # fmt: skip
        found = self._posture(theta)
        if found.margin < _SINGULAR:
            raise InputError(
                f"at the start posture {self._why(found)}", file=mechanism_of(self.model).file,
                column="closed_chain.start", remedy="give angles away from it",
            )  # fmt: skip
        return found

    def _follow(self, origin: Posture, q: np.ndarray) -> Posture | None:
        """Along L, in steps short enough for the prediction to be good; None where that fails."""
        posture, done, step = origin, 0.0, 1.0
        while done < 1.0:
            target = q if done + step >= 1.0 else origin.q + (done + step) * (q - origin.q)
            found = self._step(posture, target)
            if found is None:
                step /= 2.0
                if step < _SHORTEST:
                    return None
                continue
            posture, done = found, done + step
            step = min(2.0 * step, 1.0 - done)
        return posture if posture is not origin else self._posture(origin.theta)

    def _step(self, posture: Posture, q: np.ndarray) -> Posture | None:
        """One step of the way, or None where the prediction was too poor to be sure of the branch."""
        predicted = posture.theta + posture.slope @ (q - posture.q)
        predicted[self.serial] = q
        theta = self._solve(predicted)
        if theta is None:
            return None
        way = np.abs(predicted - posture.theta).max()
        if np.abs(theta - predicted).max() > 0.2 * way:
            return None
        found = self._posture(theta)
        return found if np.linalg.det(posture.gap_d.T @ found.gap_d) > 0.0 else None

    def _solve(self, guess: np.ndarray) -> np.ndarray | None:
        """Newton over the dependent coordinates; None if it does not close."""
        theta = guess.copy()
        for _ in range(12):
            self._move(theta)
            gap = self._gap()
            if np.abs(gap).max() < 1e-15:
                return theta
            step = np.linalg.lstsq(self._gap_jacobian()[:, self.dependent], gap, rcond=1e-12)[0]
            theta[self.dependent] -= step
            size = np.abs(step).max()
            if size < 1e-9:  # Newton converges quadratically: this step leaves rounding only
                return theta if np.abs(gap).max() < _CLOSED else None
            if not size < 10.0:
                return None
        return None

    def _posture(self, theta: np.ndarray) -> Posture:
        self._move(theta)
        jacobian = self._gap_jacobian()
        gap_d, n = jacobian[:, self.dependent], len(self.serial)
        u, values, v = np.linalg.svd(gap_d, full_matrices=False)
        inverse = (v.T / np.maximum(values, 1e-12 * values[0])) @ u.T
        slope = np.zeros((len(theta), n))
        slope[self.serial] = np.eye(n)
        slope[self.dependent] = -inverse @ jacobian[:, self.serial]
        own = np.linalg.svd(slope[self.drives], compute_uv=False)
        margin = min(values[-1] / values[0], own[-1] / own[0])
        return Posture(theta[self.serial], theta, gap_d, inverse, slope, slope[self.drives], float(margin))

    def _why(self, posture: Posture) -> str:
        own = np.linalg.svd(posture.jacobian, compute_uv=False)
        if own[-1] / own[0] <= posture.margin:
            return "the drives are at a dead point (J is singular)"
        return "the joints do not determine the drives (a loop is at a dead point)"

    def _move(self, theta: np.ndarray) -> None:
        self.data.qpos[:] = theta
        mujoco.mj_kinematics(self.m, self.data)
        mujoco.mj_comPos(self.m, self.data)

    def _gap(self) -> np.ndarray:
        at = self.data.site_xpos
        return np.concatenate([*(at[a] - at[b] for a, b in self._loops), self._bound.gap(self.data.qpos)])

    def _gap_jacobian(self) -> np.ndarray:
        rows = []
        for pair in self._loops:
            for matrix, site in zip(self._jacobians, pair, strict=True):
                mujoco.mj_jacSite(self.m, self.data, matrix, None, site)
            rows.append(self._jacobians[0] - self._jacobians[1])
        return np.concatenate([*rows, self._bound.jacobian(self.data.qpos)])


def workspace(model: Model) -> np.ndarray:
    """Lower and upper limit of each serial joint (n, 2) [rad or m].

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
    """Serial positions (n,) by joint, for messages: ``hip = 0.4, knee = 2.6 rad``."""
    return ", ".join(f"{name} = {x:.4g}" for name, x in zip(model.joints, q, strict=True))


def _start(model: Model) -> np.ndarray:
    """Serial positions to begin at: the start posture; the middle of the limits where J is constant."""
    mechanism = mechanism_of(model)
    known = dict(mechanism.start)
    stated = np.array([known.get(name, 0.0) for name in mechanism.joints])
    if not mechanism.limits:
        return stated
    low, high = workspace(model).T
    return np.clip(stated, low, high) if model.posture_dependent else (low + high) / 2.0
