"""The closed chain's equation of motion in serial coordinates, projected in MuJoCo: J depends on the posture.

    M = L^T M_tree L + J^T A J,            bias = L^T (C_tree theta_dot + M_tree gamma) + J^T A J' q_dot,
    gravity = L^T g_tree,                  damping = J^T B J

with L, gamma and J from `posture_closure`, and A, B the drives' inertia and damping at their outputs. Where
J is constant this is the paper's pulled-back inertia (Eqs. 9, 10 and 18).
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.models import Model

from .posture_closure import LoopClosure


@dataclass(frozen=True)
class PostureDynamics:
    """``mass @ a + bias + damping @ v = gravity + jacobian.T @ torque`` over N states, serial coordinates.

    Attributes:
        mass: (N, n, n) [kg m^2], rotors included.
        bias: Coriolis and centrifugal torque, the J' term included, (N, n) [N m].
        gravity: torque of gravity (N, n) [N m].
        damping: of the drives (N, n, n) [N m s/rad].
        jacobian: J (N, n, n), d q_p / d q_s.
        drives: drive positions q_p (N, n) [rad or m].
        potential: energy of the weights (N,) [J].
        margin: how far from a singular posture (N,), 1 at best and 0 there; None where it was not asked for.
    """

    mass: np.ndarray
    bias: np.ndarray
    gravity: np.ndarray
    damping: np.ndarray
    jacobian: np.ndarray
    drives: np.ndarray
    potential: np.ndarray
    margin: np.ndarray | None = None


class PostureChain:
    """The dynamics of a closed chain, exact to rounding; one Newton solution per state (about 0.2 ms).

    Args:
        model: names the closed chain and its drives.
        links_only: leave the drives' inertia and damping out.

    Raises:
        InputError: it names no closed chain, or its loops do not close at the start posture.
    """

    def __init__(self, model: Model, *, links_only: bool = False) -> None:
        self.model = model
        self._closure = LoopClosure(model)
        weight = 0.0 if links_only else 1.0
        self._rotor = weight * np.array(model.actuators.inertia)
        self._drag = weight * np.array(model.actuators.damping)

    def dynamics(self, q: np.ndarray, v: np.ndarray | None = None) -> PostureDynamics:
        """Return all terms at positions `q` and rates `v` (N, n); without `v`, at rest.

        Raises:
            SimulationError: a state where the loops cannot be closed, or that is singular; names the joints.
        """
        q = np.atleast_2d(np.asarray(q, float))
        v = np.zeros_like(q) if v is None else np.atleast_2d(np.asarray(v, float))
        rows = [self._state(*state) for state in zip(q, v, strict=True)]
        return PostureDynamics(*(np.array(column) for column in zip(*rows, strict=True)))

    def margin(self, q: np.ndarray) -> np.ndarray:
        """Return the distance of `q` (N, n) from a singular posture (N,): 1 at best, 0 there."""
        return np.array([self._closure.at(row).margin for row in np.atleast_2d(q)])

    def _state(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray | float, ...]:
        c = self._closure
        at = c.at(q)
        m, d = c.m, c.data
        rates = at.slope @ v
        gamma = c.gamma(at, rates)
        mujoco.mj_makeM(m, d)
        tree, forces, weight = np.zeros((m.nv, m.nv)), np.zeros(m.nv), np.zeros(m.nv)
        mujoco.mj_fullM(m, d, tree)
        mujoco.mj_rne(m, d, 0, forces)
        d.qvel[:] = 0.0
        mujoco.mj_comVel(m, d)
        mujoco.mj_rne(m, d, 0, weight)
        mujoco.mj_energyPos(m, d)
        j = at.jacobian
        return (
            at.slope.T @ tree @ at.slope + j.T @ (self._rotor[:, None] * j),
            at.slope.T @ (forces - weight + tree @ gamma) + j.T @ (self._rotor * gamma[c.drives]),
            -at.slope.T @ weight,
            j.T @ (self._drag[:, None] * j),
            j,
            at.theta[c.drives],
            float(d.energy[0]),
            at.margin,
        )
