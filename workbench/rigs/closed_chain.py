"""A planar mechanism with one loop, in Drake, projected onto the coordinates that its motors drive.

The loop is cut at one pin, which leaves a tree with coordinates theta. Two points must coincide,
phi(theta) = 0 (2 equations), so with independent coordinates q (the motors' joints) and dependent ones d

    theta_dot = L q_dot,            L = [I; -phi_d^-1 phi_q]
    theta_ddot = L q_ddot + gamma,  gamma = [0; -phi_d^-1 (phi_dot_theta theta_dot)]     (the L' term)

and by virtual work  M = L^T M_tree L,  bias = L^T (C_tree theta_dot + M_tree gamma),  gravity = L^T g_tree.
For a parallelogram d is linear in q, so that L is constant and gamma zero; nothing here relies on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable, SpatialInertia, UnitInertia

from workbench.core import SimulationError

GRAVITY = 9.81  # m/s^2


@dataclass(frozen=True)
class Reduced:
    """Equation of motion in the driven coordinates: ``mass @ a + bias = gravity + torque``.

    Attributes:
        mass: (2, 2) [kg m^2].
        bias: Coriolis and centrifugal torque (2,) [N m].
        gravity: torque of gravity (2,) [N m].
    """

    mass: np.ndarray
    bias: np.ndarray
    gravity: np.ndarray


class ClosedChain:
    """A mechanism with one loop read from SDF, links only (no rotors, no damping).

    Args:
        sdf: the file; its joints may include the independent ones plus two dependent ones.
        independent: names of the two driven joints, both measured from straight down.
        loop: names of the two frames whose origins coincide when the loop is closed.
        payload: point mass [kg] at the frame ``foot``.
    """

    def __init__(
        self,
        sdf: Path,
        independent: tuple[str, str] = ("hip", "crank_pin"),
        loop: tuple[str, str] = ("coupler_end", "rear_arm_end"),
        payload: float = 0.0,
    ) -> None:
        plant: Any = MultibodyPlant(0.0)  # Any: Drake's stubs misuse numpy's type parameters
        model = Parser(plant).AddModels(sdf)[0]
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
        if payload:
            at_foot: Any = np.zeros(3)
            inertia = SpatialInertia(payload, at_foot, UnitInertia(0.0, 0.0, 0.0))
            body = plant.AddRigidBody("payload", model, inertia)
            plant.WeldFrames(plant.GetFrameByName("foot"), body.body_frame())
        plant.Finalize()
        self._plant, self._context = plant, plant.CreateDefaultContext()
        self._ends = tuple(plant.GetFrameByName(name) for name in loop)
        self._driven = [plant.GetJointByName(name).position_start() for name in independent]
        self._passive = [i for i in range(plant.num_positions()) if i not in self._driven]

    def tree_position(self, q: np.ndarray) -> np.ndarray:
        """Tree coordinates theta (4,) [rad] that close the loop at driven angles `q` (2,) [rad].

        Newton from the parallelogram's own solution, which picks the branch that is not folded over.

        Raises:
            SimulationError: the loop cannot be closed there.
        """
        theta = np.zeros(self._plant.num_positions())
        theta[self._driven] = q
        theta[self._passive] = self._parallelogram_guess(q)
        for _ in range(50):
            gap = self._gap(theta)
            if np.abs(gap).max() < 1e-14:
                return theta
            step = np.linalg.lstsq(self._gap_jacobian()[:, self._passive], gap, rcond=None)[0]
            theta[self._passive] -= step
            if np.abs(step).max() < 1e-15:
                break
        if np.abs(self._gap(theta)).max() > 1e-10:
            raise SimulationError(f"the loop cannot be closed at q = {np.round(q, 4).tolist()} rad")
        return theta

    def loop_residual(self, q: np.ndarray) -> float:
        """Distance [m] between the two loop frames at driven angles `q` (2,) [rad] after closing."""
        return float(np.linalg.norm(self._gap(self.tree_position(q))))

    def projection(self, q: np.ndarray) -> np.ndarray:
        """L (4, 2), d theta / d q at driven angles `q` (2,) [rad]."""
        self._gap(self.tree_position(q))
        return self._projection()

    def reduced_dynamics(self, q: np.ndarray, v: np.ndarray) -> Reduced:
        """The equation of motion at angles `q` (2,) [rad] and speeds `v` (2,) [rad/s].

        Raises:
            SimulationError: the loop cannot be closed, or is at a dead point (links of the loop in line).
        """
        self._gap(self.tree_position(q))
        projection = self._projection()
        self._plant.SetVelocities(self._context, projection @ v)
        mass = self._plant.CalcMassMatrix(self._context)
        gamma = np.zeros(len(mass))
        curvature = self._gap_bias()
        gamma[self._passive] = -np.linalg.solve(self._gap_jacobian()[:, self._passive], curvature)
        tree_bias = self._plant.CalcBiasTerm(self._context) + mass @ gamma
        gravity = self._plant.CalcGravityGeneralizedForces(self._context)
        return Reduced(projection.T @ mass @ projection, projection.T @ tree_bias, projection.T @ gravity)

    def energy(self, q: np.ndarray, v: np.ndarray) -> float:
        """Kinetic plus potential energy [J] at `q` (2,) [rad] and `v` (2,) [rad/s]."""
        self._gap(self.tree_position(q))
        self._plant.SetVelocities(self._context, self._projection() @ v)
        kinetic = self._plant.CalcKineticEnergy(self._context)
        return float(kinetic + self._plant.CalcPotentialEnergy(self._context))

    def _parallelogram_guess(self, q: np.ndarray) -> np.ndarray:
        """Knee = q2 - q1 and coupler = q1 - q2, in the order of the passive tree coordinates."""
        knee = self._plant.GetJointByName("knee").position_start()
        return np.array([q[1] - q[0] if i == knee else q[0] - q[1] for i in self._passive])

    def _gap(self, theta: np.ndarray) -> np.ndarray:
        """x and z from the second loop frame to the first [m], shape (2,); leaves the context at theta."""
        self._plant.SetPositions(self._context, theta)
        world = self._plant.world_frame()
        first, second = (
            self._plant.CalcPointsPositions(self._context, end, [0.0, 0.0, 0.0], world) for end in self._ends
        )
        return (first - second)[[0, 2], 0]

    def _gap_jacobian(self) -> np.ndarray:
        """d gap / d theta (2, 4) [m/rad] at the context's position."""
        world, origin = self._plant.world_frame(), np.zeros(3)
        first, second = (
            self._plant.CalcJacobianTranslationalVelocity(
                self._context, JacobianWrtVariable.kQDot, end, origin, world, world
            )
            for end in self._ends
        )
        return (first - second)[[0, 2]]

    def _gap_bias(self) -> np.ndarray:
        """Second derivative of the gap at zero tree acceleration (2,) [m/s^2]."""
        world, origin = self._plant.world_frame(), np.zeros(3)
        first, second = (
            self._plant.CalcBiasTranslationalAcceleration(
                self._context, JacobianWrtVariable.kV, end, origin, world, world
            )
            for end in self._ends
        )
        return (first - second).reshape(3, -1)[[0, 2], 0]

    def _projection(self) -> np.ndarray:
        """L (4, 2) at the context's position."""
        jacobian = self._gap_jacobian()
        passive = jacobian[:, self._passive]
        if np.linalg.cond(passive) > 1e9:
            angles = np.round(self._plant.GetPositions(self._context)[self._driven], 4).tolist()
            raise SimulationError(f"the loop is at a dead point at q = {angles} rad")
        projection = np.zeros((jacobian.shape[1], 2))
        projection[self._driven] = np.eye(2)
        projection[self._passive] = -np.linalg.solve(passive, jacobian[:, self._driven])
        return projection
