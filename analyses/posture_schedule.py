"""What a posture-dependent mechanism adds to its serial tree, written into the tree's fields at every step.

The difference between closed chain and serial tree is a symmetric matrix dM(q) that depends on the posture.
Joint armatures and one fixed tendon a pair of joints, coefficients (1, 1), hold any such matrix:

    tendon_ij = dM_ij,        joint_i = dM_ii - sum_j dM_ij.

An entry may be negative; the sum with the tree's own inertia stays positive, which is all that MuJoCo needs.
So the mass matrix is the closed chain's wherever MuJoCo uses it, in contacts too, and never a torque in its
place. Drag is kept in the dampings of the same joints and tendons, and integrated implicitly where MuJoCo
does that; velocity terms and weights enter as torques. ``Euler``, ``implicit`` and ``implicitfast`` evaluate
forces once per step: with them every step is exact. ``RK4`` goes on within the step, so there fields are
written for the middle of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.models import Model, load_mjcf
from workbench.s3n.posture import PostureDependent
from workbench.s3n.worlds import INTEGRATORS
from workbench.serial_tree import SerialTree

Beyond = Literal["raise", "hold"]
_TOLERANCE = 1e-9  # size of terms that the series leave out, relative; less takes longer at every step


@dataclass(frozen=True)
class Fields:
    """Numbers to write for N states.

    Attributes:
        armature, damping: of the joints, (N, n) [kg m^2], [N m s/rad].
        pair_armature, pair_damping: of the tendons of `pairs`, (N, n (n - 1) / 2).
        torque: on the joints (N, n) [N m]: the drives' through J^T, velocity terms and weights.
    """

    armature: np.ndarray
    damping: np.ndarray
    pair_armature: np.ndarray
    pair_damping: np.ndarray
    torque: np.ndarray


class Schedule:
    """What to write into a serial tree at a state so that it is the closed chain there.

    Args:
        model: with a closed chain and its limits.
        beyond: outside the limits ``raise``, or ``hold`` what is at their edge.

    Raises:
        InputError: see `PostureDependent`.
    """

    def __init__(self, model: Model, beyond: Beyond = "raise") -> None:
        self.model, self.beyond = model, beyond
        self.pairs = tuple(combinations(range(model.size), 2))
        self.chain = PostureDependent(model, tree=SerialTree(model), tolerance=_TOLERANCE)

    def at(
        self,
        q: np.ndarray,
        v: np.ndarray,
        torque: np.ndarray,
        *,
        inertia: np.ndarray | None = None,
        damping: np.ndarray | None = None,
    ) -> Fields:
        """Return the fields for positions `q` and rates `v` (N, n) in serial coordinates.

        Args:
            q, v: states (N, n).
            torque: of the drives (N, n) [N m].
            inertia, damping: of the drives, (n,) or (N, n), in place of the model's.

        Raises:
            SimulationError: a posture outside the limits (unless `beyond` is ``hold``).
        """
        chain, n = self.chain, self.model.size
        t = chain.at(np.clip(q, *chain.box.T))
        rotor = chain.inertia if inertia is None else inertia
        thrown = rotor * t.drive_rate(v)
        on_joints = np.einsum("nai,na->ni", t.jacobian, torque - thrown)
        matrices = (
            t.links + t.pulled_back(rotor),
            t.pulled_back(chain.damping if damping is None else damping),
        )
        across = [
            np.stack([m[:, i, j] for i, j in self.pairs], axis=1) if n > 1 else np.empty((len(m), 0))
            for m in matrices
        ]
        # twice the diagonal, since a row's sum has it once
        own = [2.0 * np.einsum("nii->ni", m) - m.sum(axis=2) for m in matrices]
        return Fields(own[0], own[1], across[0], across[1], on_joints - t.link_bias(v) + t.gravity)

    def check(self, q: np.ndarray) -> None:
        """Raise if positions (N, n) lie outside the limits, unless `beyond` is ``hold``.

        Raises:
            SimulationError: names the joint, its position and its limits.
        """
        if self.beyond == "raise":
            self.chain.check(q)

    def spec(self, step: float, integrator: str) -> mujoco.MjSpec:
        """Return the model's MJCF with the tendons that hold the pairs, at zero.

        Raises:
            InputError: no such integrator.
        """
        if integrator not in INTEGRATORS:
            raise InputError(
                f"no integrator is called '{integrator}'", remedy=f"choose one of {', '.join(INTEGRATORS)}"
            )
        spec = load_mjcf(self.model.serial)
        for kind in (spec.keys, spec.sensors, spec.actuators):
            for element in list(kind):
                spec.delete(element)
        for i, j in self.pairs:
            tendon = spec.add_tendon(name=pair_tendon(i, j))
            for k in (i, j):
                tendon.wrap_joint(self.model.joints[k], 1.0)
        spec.option.timestep, spec.option.integrator = step, INTEGRATORS[integrator]
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        return spec


def pair_tendon(i: int, j: int) -> str:
    """Return the name of the tendon that holds entry (i, j)."""
    return f"posture:{i}:{j}"
